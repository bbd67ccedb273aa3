// SPDX-License-Identifier: Apache-2.0
// What tells pictures apart in 32 digits: XXH3 of 128 bits (the xxHash library), which finds accidents, not forgery.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace anamorph {

/// A hash, its bytes in the order in which they are written.
using PictureHash = std::array<std::uint8_t, 16>;

/// Its 32 hexadecimal digits.
std::string hash_digits(const PictureHash& hash);
/// The hash that has these digits. Throws Error, which calls it `what`, where they are not 32 hexadecimal ones.
PictureHash hash_from_digits(std::string_view digits, const std::string& what);

/// The numbers that are hashed.
struct HashedNumbers {
    int bytes;      ///< of each: 1, 2, 4 or 8
    bool floating;  ///< IEEE's, not whole ones
};

/// Hashes what it is given, as one text, however it comes in pieces.
class PictureHasher {
  public:
    PictureHasher();
    ~PictureHasher();
    PictureHasher(const PictureHasher&) = delete;
    PictureHasher& operator=(const PictureHasher&) = delete;

    void add(std::string_view text);
    void add(const PictureHash& hash);
    /// Numbers, a whole number of them, as bytes of which the first is worth least. Of floating ones every NaN is the same: which
    /// bits a processor gives those that it makes is its own affair.
    void add_numbers(std::span<const std::byte> numbers, HashedNumbers kind);
    PictureHash hash() const;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace anamorph
