// SPDX-License-Identifier: Apache-2.0
// A fuzz target without libFuzzer: runs it on every file of a folder, on the beginnings of each, and with memory that cannot be
// had, once at each place that asks for some. What it then throws must be std::bad_alloc; leaks are the sanitizer's to find.
// Files are such as are read, unless their names begin with bad_.
#include <execinfo.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "expect_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

/// Allocations of this thread are counted while `counts`; number `failing` fails, and each is given to `seen`.
struct Memory {
    bool counts = false;
    long count = 0, failing = -1;
    void (*seen)() = nullptr;
};
thread_local Memory memory;

void* allocate(std::size_t size, std::size_t alignment) {
    if (memory.counts && anamorph::fuzz::memory_may_fail) {
        if (memory.count++ == memory.failing) throw std::bad_alloc();
        if (memory.seen) memory.seen();
    }
    const std::size_t whole = (size + alignment - 1) / alignment * alignment;
    if (void* p = std::aligned_alloc(alignment, whole ? whole : alignment)) return p;
    throw std::bad_alloc();
}

/// The number of the first allocation at each place, told by the calls that lead to it.
std::vector<long> new_places;
std::set<std::uint64_t> known_places;
void note_place() {
    memory.counts = false;
    constexpr int kDepth = 20;
    void* calls[kDepth];
    const int depth = backtrace(calls, kDepth);
    std::uint64_t hash = 1469598103934665603u;
    for (int i = 0; i < depth; ++i)
        hash = (hash ^ reinterpret_cast<std::uintptr_t>(calls[i])) * 1099511628211u;
    if (known_places.insert(hash).second) new_places.push_back(memory.count - 1);
    memory.counts = true;
}

/// Runs the target; says how often it asked for memory.
long run(const std::string& input, long failing = -1, void (*seen)() = nullptr) {
    memory = {true, 0, failing, seen};
    anamorph::fuzz::memory_may_fail = true;
    try {
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
    } catch (const std::bad_alloc&) {
        anamorph::fuzz::require(failing >= 0, "there is memory");
    }
    return std::exchange(memory, {}).count;
}

std::string contents(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

void* operator new(std::size_t size) {
    return allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* p) noexcept {
    std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
    std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
    std::free(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
    std::free(p);
}

int main(int argc, char** argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]), 2;
    long inputs = 0, beginnings = 0, failures = 0;
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
        const std::string input = contents(entry.path());
        ++inputs;
        // Which file it was is said before it can fail.
        std::printf("%s\n", entry.path().filename().c_str());
        std::fflush(stdout);
        // The first time makes what then stays.
        anamorph::fuzz::accepted = 0;
        run(input);
        anamorph::fuzz::require(
            anamorph::fuzz::accepted > 0 || entry.path().filename().string().starts_with("bad_"),
            "the file is read");
        new_places.clear();
        run(input, -1, note_place);
        constexpr std::size_t kBeginnings = 64;
        for (std::size_t i = 0; i < kBeginnings && !input.empty(); ++i, ++beginnings)
            run(input.substr(0, input.size() * i / kBeginnings));
        for (const long place : new_places) {
            anamorph::fuzz::require(run(input, place) > place, "each run asks for the same memory");
            ++failures;
        }
    }
    std::printf("%ld inputs, %ld beginnings, %ld failing allocations\n", inputs, beginnings, failures);
    return inputs == 0;
}
