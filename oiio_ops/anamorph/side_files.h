// SPDX-License-Identifier: Apache-2.0
// The files that shape a picture, opened by OpenImageIO: text, and images whose pixels are numbers.
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <map>
#include <memory>
#include <string>

#include "anamorph/operation/side_files.h"

namespace anamorph {

/// Reads files of the file system, and whatever images OpenImageIO reads; these past any cache, on the
/// calling thread alone.
const SideFileReader& side_file_reader();

/// Side files that are not files: texts and images by the names that values give them. Keeps references to the images.
struct MemoryFiles {
    std::map<std::string, std::string> texts = {};
    std::map<std::string, const OIIO::ImageBuf*> images = {};
};

/// Hands over what is in memory, and reads all others. Keeps a reference.
class MemoryFileReader final : public SideFileReader {
  public:
    explicit MemoryFileReader(const MemoryFiles& files) : m_files(files) {}
    std::string text(const std::string& name) const override;
    bool exists(const std::string& name) const override;
    std::unique_ptr<SideImage> image(const std::string& key, const std::string& name) const override;

  private:
    const MemoryFiles& m_files;
};

/// A reader whose errors begin with the key that a file is named by: "mesh: file ... does not exist". Keeps references.
class KeyedFileReader final : public SideFileReader {
  public:
    explicit KeyedFileReader(const SideFiles& files, const SideFileReader& reader = side_file_reader())
        : m_files(files), m_reader(reader) {}
    std::string text(const std::string& name) const override;
    bool exists(const std::string& name) const override { return m_reader.exists(name); }
    std::unique_ptr<SideImage> image(const std::string& key, const std::string& name) const override;

  private:
    const SideFiles& m_files;
    const SideFileReader& m_reader;
};

/// Has an image that was opened as this file, in the state that its identity tells, several parts, of which the first is read?
bool is_first_of_parts(const SideFile& file);

}  // namespace anamorph
