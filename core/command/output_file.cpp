// SPDX-License-Identifier: Apache-2.0
#include "output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <mutex>

#include "anamorph/error.h"

namespace anamorph::command {
namespace {

namespace fs = std::filesystem;

/// Names of unfinished files, in a form that a signal handler may read.
struct Unfinished {
    static constexpr std::size_t kLongest = 4096;
    std::atomic<bool> used = false;
    char name[kLongest] = {};
};
constinit std::array<Unfinished, 260> g_unfinished{};  // of one thread each, and a few more

/// Takes away what is unfinished, and ends the program as the signal would have.
extern "C" void anamorph_remove_unfinished(int signal) {
    for (const Unfinished& file : g_unfinished)
        if (file.used.load()) unlink(file.name);
    raise(signal);  // when the handler returns; SA_RESETHAND has put the default back
}

void handle_signals() {
    static const bool once = [] {
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
            struct sigaction action = {};
            if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) continue;
            action.sa_handler = anamorph_remove_unfinished;
            action.sa_flags = static_cast<int>(SA_RESETHAND);
            sigaction(signal, &action, nullptr);
        }
        return true;
    }();
    static_cast<void>(once);
}

/// nullptr where there is no room: the file is then not taken away after a signal.
Unfinished* remember(const std::string& name) {
    if (name.size() >= Unfinished::kLongest) return nullptr;
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    for (Unfinished& file : g_unfinished) {
        if (file.used.load()) continue;
        std::memcpy(file.name, name.c_str(), name.size() + 1);
        file.used.store(true);
        return &file;
    }
    return nullptr;
}

}  // namespace

struct OutputFile::Impl {
    static constexpr std::size_t kBlock = std::size_t{1} << 16;

    explicit Impl(const std::string& given) : name(given) {
        if (name == "-") {
            file = STDOUT_FILENO;
            return;
        }
        std::error_code error;
        place = name;
        if (fs::is_symlink(place, error)) place = fs::canonical(place, error);
        const fs::file_status status = fs::status(place, error);
        const bool there = fs::exists(status);
        if (there && access(place.c_str(), W_OK) != 0) fail();
        if (!there || fs::is_regular_file(status)) open_beside(there);
        // Devices, pipes, and files in folders where no other can be made.
        if (file < 0 && there) file = open(place.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
        if (file < 0) fail();
    }
    ~Impl() {
        if (file >= 0 && file != STDOUT_FILENO) ::close(file);
        if (!beside.empty()) unlink(beside.c_str());
        forget();
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    /// Opens a file with a name of its own in the same folder, and the rights of the one to be replaced.
    void open_beside(bool replaces) {
        constexpr std::size_t kMostOfName = 200;
        constexpr int kTries = 100;
        handle_signals();
        const std::string base = place.filename().string().substr(0, kMostOfName);
        // Writers may choose by it what they write.
        const std::string extension = place.extension().string();
        const std::string ending = ".part" + (extension.size() < 16 ? extension : "");
        for (int k = 0; k < kTries && file < 0; ++k) {
            beside = (place.parent_path() /
                      ("." + base + "." + std::to_string(getpid()) + "." + std::to_string(k) + ending))
                         .string();
            file = open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            if (file < 0 && errno != EEXIST) break;
        }
        if (file < 0) {
            beside.clear();
            return;
        }
        unfinished = remember(beside);
        struct stat old = {};
        if (replaces && stat(place.c_str(), &old) == 0) static_cast<void>(fchmod(file, old.st_mode & 07777));
    }

    void flush() {
        const char* at = buffer.data();
        for (std::size_t left = buffer.size(); left > 0;) {
            const ssize_t written = ::write(file, at, left);
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) fail();
            at += written;
            left -= static_cast<std::size_t>(written);
        }
        buffer.clear();
    }

    void finish() {
        flush();
        if (file == STDOUT_FILENO) return;
        const int closed = ::close(file);
        file = -1;
        if (closed != 0) fail();
        if (beside.empty()) return;
        if (std::rename(beside.c_str(), place.c_str()) != 0) fail();
        beside.clear();
        forget();
    }

    void forget() {
        if (unfinished) unfinished->used.store(false);
        unfinished = nullptr;
    }

    [[noreturn]] void fail() const {
        const int reason = errno;
        throw Error("cannot write " + (name == "-" ? "to the standard output" : name) +
                    (reason ? std::string(": ") + std::strerror(reason) : ""));
    }

    std::string name, buffer;
    fs::path place;      ///< what `name` leads to
    std::string beside;  ///< written instead until all is written; empty where there is none
    Unfinished* unfinished = nullptr;
    int file = -1;
};

OutputFile::OutputFile(const std::string& name) : m_impl(std::make_unique<Impl>(name)) {}

OutputFile::~OutputFile() = default;

void OutputFile::write(std::string_view text) {
    m_impl->buffer += text;
    if (m_impl->buffer.size() >= Impl::kBlock) m_impl->flush();
}

std::string OutputFile::path() const {
    if (m_impl->name == "-") throw Error("--output=-: must be the name of a file");
    return m_impl->beside.empty() ? m_impl->place.string() : m_impl->beside;
}

void OutputFile::close() {
    m_impl->finish();
}

}  // namespace anamorph::command
