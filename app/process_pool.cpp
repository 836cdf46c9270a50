#include "app/process_pool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <stdexcept>
#include <thread>

#include "app/interrupt.hpp"

namespace stillkite {
namespace {

using Clock = std::chrono::steady_clock;

// Runs in the child after fork(): calls only functions that are safe there.
[[noreturn]] void become(char* const* arguments, const char* messages, pid_t parent) {
  setpgid(0, 0);  // the parent forwards Ctrl-C
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  const int nowhere = open("/dev/null", O_RDWR);
  const int log = open(messages, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (nowhere < 0 || log < 0) _exit(1);
  dup2(nowhere, STDIN_FILENO);
  dup2(nowhere, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  execv("/proc/self/exe", arguments);
  _exit(127);
}

pid_t start_process(const ProcessCommand& command) {
  std::string program = "stillkite";
  std::vector<std::string> words = command.arguments;
  std::vector<char*> arguments{program.data()};
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) {
    throw std::runtime_error(fmt::format("cannot start a process: {}", std::strerror(errno)));
  }
  if (child == 0) become(arguments.data(), command.messages.c_str(), parent);
  return child;
}

// Last line of the messages, without the program's name.
std::string last_message(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) last = line;
  }
  constexpr std::string_view kProgram = "stillkite: ";
  return last.starts_with(kProgram) ? last.substr(kProgram.size()) : last;
}

std::optional<std::string> failure_of(int status, const std::filesystem::path& messages) {
  if (WIFSIGNALED(status)) {
    return fmt::format("ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  }
  if (WEXITSTATUS(status) == 0) return std::nullopt;
  const std::string message = last_message(messages);
  return message.empty() ? fmt::format("exit status {}", WEXITSTATUS(status)) : message;
}

/// Running children; killed by the destructor.
class Children {
 public:
  Children() = default;
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;
  ~Children() {
    signal_all(SIGKILL);
    for (const auto& [pid, child] : running_) waitpid(pid, nullptr, 0);
  }

  struct Child {
    std::size_t index = 0;
    Clock::time_point start;
  };
  struct Ended {
    Child child;
    int status = 0;
  };

  void start(const ProcessCommand& command, std::size_t index) {
    running_[start_process(command)] = {.index = index, .start = Clock::now()};
  }
  void signal_all(int signal) const {
    for (const auto& [pid, child] : running_) kill(pid, signal);
  }
  [[nodiscard]] std::size_t count() const { return running_.size(); }

  // A child that has ended; nullopt after a moment without one.
  [[nodiscard]] std::optional<Ended> next_end() {
    for (const auto& [pid, child] : running_) {
      Ended ended{.child = child};
      if (waitpid(pid, &ended.status, WNOHANG) != pid) continue;
      running_.erase(pid_t{pid});  // not by a reference into the erased entry
      return ended;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return std::nullopt;
  }

 private:
  std::map<pid_t, Child> running_;
};

}  // namespace

void run_processes(std::span<const ProcessCommand> commands, int processes,
                   const std::function<void(std::size_t)>& before_start,
                   const std::function<void(std::size_t, const ProcessEnd&)>& after_end) {
  setenv("OPENCV_FOR_THREADS_NUM", "1", 1);
  Children children;
  std::size_t next = 0;
  bool is_stopped = false;
  while (children.count() > 0 || (next < commands.size() && !is_stopped)) {
    if (interrupted() && !is_stopped) {
      is_stopped = true;
      children.signal_all(SIGINT);
    }
    if (!is_stopped && next < commands.size() &&
        children.count() < static_cast<std::size_t>(processes)) {
      before_start(next);
      children.start(commands[next], next);
      ++next;
      continue;
    }
    const auto ended = children.next_end();
    if (!ended) continue;
    const std::size_t index = ended->child.index;
    const auto failure = failure_of(ended->status, commands[index].messages);
    if (is_stopped && failure) continue;  // it was interrupted
    const std::chrono::duration<double> wall = Clock::now() - ended->child.start;
    after_end(index, {.failure = failure, .wall_s = wall.count()});
  }
}

}  // namespace stillkite
