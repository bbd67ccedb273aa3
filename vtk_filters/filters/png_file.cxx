// SPDX-License-Identifier: Apache-2.0
#include "png_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>

#include "anamorph/error.h"

namespace anamorph_vtk {
namespace {

using anamorph::Error;

constexpr char kSignature[] = "\x89PNG\r\n\x1a\n";
constexpr std::size_t kSignatureSize = 8;

/// CRC-32 as in ISO 3309: the remainders of each byte.
constexpr std::array<std::uint32_t, 256> remainders() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
        table[n] = n;
        for (int k = 0; k < 8; ++k) table[n] = (table[n] >> 1) ^ ((table[n] & 1) != 0 ? 0xedb88320u : 0);
    }
    return table;
}

class Checksum {
  public:
    void add(const char* bytes, std::size_t count) {
        static constexpr std::array<std::uint32_t, 256> kRemainders = remainders();
        for (std::size_t i = 0; i < count; ++i)
            m_rest = kRemainders[(m_rest ^ static_cast<unsigned char>(bytes[i])) & 0xff] ^ (m_rest >> 8);
    }
    std::uint32_t value() const { return ~m_rest; }

  private:
    std::uint32_t m_rest = 0xffffffffu;
};

std::uint32_t number_in(const char* bytes) {
    std::uint32_t number = 0;
    for (int i = 0; i < 4; ++i) number = number << 8 | static_cast<unsigned char>(bytes[i]);
    return number;
}

class Chunks {
  public:
    explicit Chunks(const std::string& path) : m_path(path), m_file(path, std::ios::binary) {}

    bool is_png() {
        char head[kSignatureSize];
        return m_file.read(head, kSignatureSize) && std::equal(head, head + kSignatureSize, kSignature);
    }
    /// Throws Error unless the next one is whole. False after the last.
    bool next() {
        char head[8], sum[4];
        read(head, sizeof head);
        Checksum checksum;
        checksum.add(head + 4, 4);
        std::array<char, 1 << 14> block;
        for (std::size_t left = number_in(head); left > 0;) {
            const std::size_t size = std::min(left, block.size());
            read(block.data(), size);
            checksum.add(block.data(), size);
            left -= size;
        }
        read(sum, sizeof sum);
        if (number_in(sum) != checksum.value())
            throw Error("FileName", m_path, "the file is damaged: the checksum of a chunk is wrong");
        return std::string(head + 4, 4) != "IEND";
    }

  private:
    void read(char* to, std::size_t count) {
        if (!m_file.read(to, static_cast<std::streamsize>(count)))
            throw Error("FileName", m_path, "the file ends before the picture does");
    }

    std::string m_path;
    std::ifstream m_file;
};

}  // namespace

void check_png(const std::string& path) {
    Chunks chunks(path);
    if (!chunks.is_png()) return;
    while (chunks.next()) {
    }
}

}  // namespace anamorph_vtk
