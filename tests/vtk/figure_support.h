// SPDX-License-Identifier: Apache-2.0
// What the tests of the figure classes share.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

/// A folder that is removed with it.
class Folder {
  public:
    Folder() {
        static int count = 0;
        m_path = std::filesystem::temp_directory_path() /
                 ("anamorph_figures_" + std::to_string(getpid()) + "_" + std::to_string(++count));
        std::filesystem::create_directories(m_path);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(m_path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::string path(const std::string& name) const { return (m_path / name).string(); }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
        return path(name);
    }

  private:
    std::filesystem::path m_path;
};

/// Two bodies, joined, that move for four frames.
inline const std::string kTwoBodies =
    "figure f 2 a b\n"
    "ellipsoid a 10 40 20\n"
    "ellipsoid b 5 20 8\n"
    "joint j a 0 40 0 b 0 -20 0\n"
    "repeat 0 1 colour a 10 20 30\n"
    "repeat 0 1 texture b wood 3 4\n"
    "repeat 0 1 moveto f a 100 200 300\n"
    "repeat 0 1 bendby b j world 90 x\n"
    "linear 0 4 moveby f world 40 0 -8\n"
    "stop\n";
