// SPDX-License-Identifier: Apache-2.0
#include "program_run.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "anamorph/parameter/parameter.h"

namespace anamorph::command {
namespace {

constexpr std::size_t kMostText = 64 * 1024;

using Clock = std::chrono::steady_clock;

/// Becomes the program. Between fork and exec only calls that are safe there.
[[noreturn]] void become(char** argv, int out) {
    const int nothing = open("/dev/null", O_RDONLY);
    if (nothing >= 0) dup2(nothing, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    setpgid(0, 0);  // what it starts ends with it
    execv(argv[0], argv);
    _exit(127);
}

/// Whether `child` has ended; its status can still be had.
bool has_ended(pid_t child) {
    siginfo_t what{};
    return waitid(P_PID, static_cast<id_t>(child), &what, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           what.si_pid == child;
}

/// Reads what comes until the other end is closed, `child` has ended, though what it left running has the
/// other end still, or it is `end`; false for the last.
bool read_until(int in, pid_t child, Clock::time_point end, std::string& text) {
    char buffer[4096];
    while (true) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
        if (left <= 0) return false;
        pollfd ready{in, POLLIN, 0};
        const int found = poll(&ready, 1, static_cast<int>(std::min<long long>(left, 100)));
        if (found < 0 && errno != EINTR) return true;
        if (found == 0 && has_ended(child)) return true;
        if (found <= 0) continue;
        const ssize_t count = read(in, buffer, sizeof buffer);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return true;
        if (text.size() < kMostText) text.append(buffer, static_cast<std::size_t>(count));
    }
}

int status_of(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::string ProgramRun::last_line() const {
    const std::size_t end = text.find_last_not_of(" \t\r\n");
    if (end == std::string::npos) return "";
    const std::size_t before = text.find_last_of('\n', end);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    return printable(text.substr(begin, end + 1 - begin));
}

std::string ProgramRun::after(const std::string& mark) const {
    const std::size_t found = ("\n" + text).rfind("\n" + mark);
    if (found == std::string::npos) return "";
    const std::size_t begin = found + mark.size();
    return printable(text.substr(begin, text.find('\n', begin) - begin));
}

std::string find_program(const std::string& name) {
    const char* path = std::getenv("PATH");
    const std::string folders = path ? path : "/usr/local/bin:/usr/bin:/bin";
    for (std::size_t at = 0; at <= folders.size();) {
        const std::size_t end = std::min(folders.find(':', at), folders.size());
        const std::string file = folders.substr(at, end - at) + "/" + name;
        struct stat found;
        if (end > at && stat(file.c_str(), &found) == 0 && S_ISREG(found.st_mode) &&
            access(file.c_str(), X_OK) == 0)
            return file;
        at = end + 1;
    }
    return "";
}

ProgramRun run_program(const std::vector<std::string>& words, int seconds) {
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw Error(std::string("no pipe: ") + std::strerror(errno));
    const pid_t child = fork();
    if (child == 0) become(argv.data(), ends[1]);
    close(ends[1]);
    if (child < 0) {
        close(ends[0]);
        throw Error(std::string("no process: ") + std::strerror(errno));
    }
    ProgramRun result;
    const bool ended = read_until(ends[0], child, Clock::now() + std::chrono::seconds(seconds), result.text);
    close(ends[0]);
    if (!ended) {
        kill(-child, SIGKILL);
        kill(child, SIGKILL);
    }
    result.status = status_of(child);
    if (!ended) result.status = -1;
    return result;
}

}  // namespace anamorph::command
