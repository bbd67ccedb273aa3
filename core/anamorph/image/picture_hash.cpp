// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/picture_hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {

static_assert(std::endian::native == std::endian::little, "bytes are hashed as they stand in memory");

struct PictureHasher::State {
    XXH3_state_t xxh3;
};

PictureHasher::PictureHasher() : m_state(std::make_unique<State>()) {
    XXH3_128bits_reset(&m_state->xxh3);
}
PictureHasher::~PictureHasher() = default;

void PictureHasher::add(std::string_view text) {
    XXH3_128bits_update(&m_state->xxh3, text.data(), text.size());
}

void PictureHasher::add(const PictureHash& hash) {
    XXH3_128bits_update(&m_state->xxh3, hash.data(), hash.size());
}

namespace {

/// Copies numbers of `from` that are whole numbers of a type, with one NaN for all: those above infinity's bits, but for the sign.
template <class Bits>
void copy_with_one_nan(const std::byte* from, std::size_t bytes, Bits infinity, std::byte* to) {
    constexpr Bits kMagnitude = static_cast<Bits>(~Bits{0}) >> 1;
    const Bits nan = static_cast<Bits>(infinity | ((infinity >> 1) & ~infinity));
    for (std::size_t i = 0; i < bytes; i += sizeof(Bits)) {
        Bits number;
        std::memcpy(&number, from + i, sizeof(Bits));
        if ((number & kMagnitude) > infinity) number = nan;
        std::memcpy(to + i, &number, sizeof(Bits));
    }
}

}  // namespace

void PictureHasher::add_numbers(std::span<const std::byte> numbers, HashedNumbers kind) {
    if (!kind.floating) {
        XXH3_128bits_update(&m_state->xxh3, numbers.data(), numbers.size());
        return;
    }
    std::array<std::byte, 4096> part;
    for (std::size_t i = 0; i < numbers.size(); i += part.size()) {
        const std::size_t bytes = std::min(part.size(), numbers.size() - i);
        const std::byte* from = numbers.data() + i;
        if (kind.bytes == 2)
            copy_with_one_nan<std::uint16_t>(from, bytes, 0x7c00, part.data());
        else if (kind.bytes == 4)
            copy_with_one_nan<std::uint32_t>(from, bytes, 0x7f800000, part.data());
        else
            copy_with_one_nan<std::uint64_t>(from, bytes, 0x7ff0000000000000, part.data());
        XXH3_128bits_update(&m_state->xxh3, part.data(), bytes);
    }
}

PictureHash PictureHasher::hash() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(&m_state->xxh3));
    PictureHash hash;
    static_assert(sizeof(canonical.digest) == sizeof(hash));
    std::memcpy(hash.data(), canonical.digest, sizeof(hash));
    return hash;
}

std::string hash_digits(const PictureHash& hash) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : hash) {
        text += kDigits[byte >> 4];
        text += kDigits[byte & 15];
    }
    return text;
}

PictureHash hash_from_digits(std::string_view digits, const std::string& what) {
    const auto refuse = [&] {
        return Error(what, printable(digits), "must be 32 hexadecimal digits, 0-9 and a-f");
    };
    PictureHash hash{};
    if (digits.size() != 2 * hash.size()) throw refuse();
    for (std::size_t i = 0; i < digits.size(); ++i) {
        constexpr std::string_view kDigits = "0123456789abcdef";
        const std::size_t digit = kDigits.find(digits[i]);
        if (digit == std::string_view::npos) throw refuse();
        hash[i / 2] = static_cast<std::uint8_t>(hash[i / 2] * 16 + digit);
    }
    return hash;
}

}  // namespace anamorph
