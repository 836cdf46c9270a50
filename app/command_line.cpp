#include "app/command_line.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "app/commands.hpp"
#include "app/interrupt.hpp"
#include "geometry/fields.hpp"

namespace stillkite {
namespace {

/// Exit status of the command.
enum class ExitCode { done = 0, failed = 1, wrong_input = 2, interrupted = 130 };

ExitCode fail(ExitCode code, const char* message) {
  std::fprintf(stderr, "stillkite: %s\n", message);
  return code;
}

// The subcommands run inside the parse, as CLI11's callbacks.
ExitCode parse_and_run(int argc, char** argv, const std::string& version) {
  CLI::App app("Visual navigation of a drone from one camera, without GNSS.", "stillkite");
  app.set_version_flag("--version", "stillkite " + version);
  app.require_subcommand(1);
  app.failure_message([](const CLI::App* at, const CLI::Error& error) {
    return fmt::format("stillkite: {}\nTry: {} --help\n", error.what(), at->get_name());
  });
  app.footer(
      "Keys of a run with default and description: stillkite config > my.yaml\n"
      "Keys of a live flight: stillkite fly --print; of a simulated one: stillkite simulate "
      "--print; of the trials: stillkite hover --print\n"
      "Exit status: 0 done, 1 failure, 2 wrong use or input, 130 interrupted.");

  add_run(app);
  add_fly(app);
  add_replay(app);
  add_simulate(app);
  add_evaluate(app);
  add_compare(app);
  add_hover(app);
  add_batch(app);
  add_import(app);
  add_check(app);
  add_calibrate(app);
  add_config(app);

  const std::string first = argc > 1 ? argv[1] : "";
  const auto is_it = [&](const CLI::App* command) { return command->get_name() == first; };
  const std::vector<CLI::App*> commands = app.get_subcommands({});
  if (!first.empty() && first[0] != '-' && std::ranges::none_of(commands, is_it)) {
    throw InputError(first + ": unknown subcommand; see stillkite --help");
  }
  try {
    app.parse(argc, argv);
    return ExitCode::done;
  } catch (const CLI::ParseError& error) {
    const bool is_help = error.get_exit_code() == 0;  // --help, --version
    app.exit(error);
    return is_help ? ExitCode::done : ExitCode::wrong_input;
  }
}

ExitCode exit_code_of(int argc, char** argv, const std::string& version) {
  try {
    return parse_and_run(argc, argv, version);
  } catch (const InputError& error) {
    // the signal interrupted open()
    if (interrupted()) return fail(ExitCode::interrupted, "interrupted");
    return fail(ExitCode::wrong_input, error.what());
  } catch (const Interrupted&) {
    return ExitCode::interrupted;
  } catch (const CheckFailed& found) {
    return found.is_wrong ? ExitCode::wrong_input : ExitCode::failed;
  } catch (const std::exception& error) {
    return fail(ExitCode::failed, error.what());
  } catch (...) {
    return fail(ExitCode::failed, "unknown error");
  }
}

// A closed one would be given to the next file that is opened: output would end up in results.
void open_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) < 0) static_cast<void>(open("/dev/null", O_RDWR));
  }
}

}  // namespace

int run_command_line(int argc, char** argv, const std::string& version) {
  open_standard_descriptors();
  std::signal(SIGXFSZ, SIG_IGN);  // write() then returns an error at a file size limit
  catch_interrupts();
  const ExitCode code = exit_code_of(argc, argv, version);
  if (std::fflush(stdout) != 0 && code == ExitCode::done) {
    return static_cast<int>(fail(ExitCode::failed, "cannot write standard output"));
  }
  return static_cast<int>(code);
}

}  // namespace stillkite
