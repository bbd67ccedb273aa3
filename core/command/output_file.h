// SPDX-License-Identifier: Apache-2.0
// Files that are there in full or not at all.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace anamorph::command {

/// What a file, or the standard output as "-", is written by. A file is written beside its place, under a
/// name that begins with a point, and takes its place when it is closed: whatever stands there stays until
/// then, and for good where the program fails or is interrupted (SIGINT, SIGTERM, SIGHUP), which leaves
/// nothing else behind. Devices and pipes are written directly. Throws Error where it cannot be done.
class OutputFile {
  public:
    explicit OutputFile(const std::string& name);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(std::string_view text);
    /// The file, for another program to write it instead. Throws Error for the standard output.
    std::string path() const;
    void close();

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace anamorph::command
