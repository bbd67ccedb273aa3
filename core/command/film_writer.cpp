// SPDX-License-Identifier: Apache-2.0
#include "film_writer.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "output_file.h"

extern char** environ;

namespace anamorph::command {
namespace {

/// A program with pipes to its input and from its messages.
class Child {
  public:
    explicit Child(std::vector<std::string> arguments) {
        std::array<int, 2> in{}, messages{};
        if (pipe2(in.data(), O_CLOEXEC) != 0 || pipe2(messages.data(), O_CLOEXEC) != 0)
            throw Error("cannot start " + arguments[0]);
        m_input = in[1];
        m_messages = messages[0];
        std::vector<char*> argv;
        for (std::string& argument : arguments) argv.push_back(argument.data());
        argv.push_back(nullptr);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, messages[1], STDERR_FILENO);
        const int failed = posix_spawnp(&m_process, argv[0], &actions, nullptr, argv.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        ::close(in[0]);
        ::close(messages[1]);
        if (failed != 0) m_process = -1;
    }
    ~Child() { wait(); }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    bool started() const { return m_process > 0; }

    /// False when the program no longer reads.
    bool write(const std::uint8_t* data, std::size_t size) {
        while (size > 0) {
            const ssize_t written = ::write(m_input, data, size);
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) return false;
            data += written;
            size -= static_cast<std::size_t>(written);
        }
        return true;
    }

    /// Ends the input and waits; whether all went well. `message`: what the program said.
    bool wait(std::string* message = nullptr) {
        if (m_input >= 0) ::close(m_input);
        m_input = -1;
        std::array<char, 4096> block{};
        while (m_messages >= 0) {
            const ssize_t count = ::read(m_messages, block.data(), block.size());
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) {
                ::close(m_messages);
                m_messages = -1;
            } else if (message) {
                message->append(block.data(), static_cast<std::size_t>(count));
            }
        }
        int status = -1;
        if (m_process > 0)
            while (waitpid(m_process, &status, 0) < 0 && errno == EINTR) continue;
        m_process = -1;
        return status == 0;
    }

  private:
    pid_t m_process = -1;
    int m_input = -1, m_messages = -1;
};

class FfmpegWriter final : public FilmWriter {
  public:
    FfmpegWriter(const std::string& name, int width, int height, double frames_per_second)
        : m_file(name),
          m_child({"ffmpeg",
                   "-hide_banner",
                   "-loglevel",
                   "error",
                   "-y",
                   "-f",
                   "rawvideo",
                   "-pix_fmt",
                   "rgb24",
                   "-video_size",
                   std::to_string(width) + "x" + std::to_string(height),
                   "-framerate",
                   shortest(frames_per_second),
                   "-i",
                   "-",
                   "-vf",
                   "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                   "-pix_fmt",
                   "yuv420p",
                   "-f",
                   format_of(name),
                   m_file.path()}) {
        // A program that ends early is told of by wait().
        std::signal(SIGPIPE, SIG_IGN);
    }

    void add(const FilmFrame& frame) override {
        if (!m_child.write(frame.pixels.data(), frame.pixels.size())) finish();
    }
    void finish() override {
        std::string message;
        if (!m_child.wait(&message))
            throw Error("ffmpeg failed" + (message.empty() ? std::string() : ": " + message));
        m_file.close();
    }

  private:
    /// ffmpeg tells formats by endings, which the unfinished file does not have.
    static std::string format_of(const std::string& name) {
        const std::string ending = std::filesystem::path(name).extension().string();
        if (ending == ".mkv") return "matroska";
        if (ending == ".webm" || ending == ".gif" || ending == ".avi" || ending == ".mov")
            return ending.substr(1);
        if (ending == ".mp4") return "mp4";
        throw Error("--output", name,
                    "must end in .mp4, .mov, .mkv, .webm, .avi or .gif, or in .png for pictures");
    }

    OutputFile m_file;
    Child m_child;
};

}  // namespace

bool has_ffmpeg() {
    Child child({"ffmpeg", "-version"});
    return child.started() && child.wait();
}

std::unique_ptr<FilmWriter> ffmpeg_writer(const std::string& name, int width, int height,
                                          double frames_per_second) {
    return std::make_unique<FfmpegWriter>(name, width, height, frames_per_second);
}

}  // namespace anamorph::command
