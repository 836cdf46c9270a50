#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/commands.hpp"
#include "app/interrupt.hpp"
#include "app/job_list.hpp"
#include "app/job_record.hpp"
#include "app/options.hpp"
#include "app/process_pool.hpp"
#include "app/study_results.hpp"
#include "app/study_table.hpp"
#include "io/file_digest.hpp"
#include "io/report/study_report.hpp"
#include "io/results/json_text.hpp"
#include "io/results/output_file.hpp"
#include "io/results/part_file.hpp"
#include "io/text_file.hpp"

namespace stillkite {
namespace {

namespace fs = std::filesystem;

struct BatchArguments {
  fs::path study;
  std::vector<std::string> overrides;
  std::vector<std::string> only;
  fs::path out;
  std::string shard;
  int jobs = 0;
  bool list = false;
  bool json = false;
};

// Keeps the given configurations; all without names.
void select_configurations(Study& study, const std::vector<std::string>& names) {
  const auto has_name = [](const std::string& name) {
    return [&name](const Study::Configuration& c) { return c.name == name; };
  };
  for (const std::string& name : names) {
    if (std::ranges::any_of(study.configurations, has_name(name))) continue;
    std::vector<std::string> known;
    for (const auto& configuration : study.configurations) known.push_back(configuration.name);
    throw InputError(fmt::format("--only: '{}' is not a configuration of the study; known: {}",
                                 name, fmt::join(known, ", ")));
  }
  if (names.empty()) return;
  std::erase_if(study.configurations, [&](const Study::Configuration& configuration) {
    return std::ranges::find(names, configuration.name) == names.end();
  });
}

fs::path study_folder(const BatchArguments& arguments, const Study& study) {
  if (!arguments.out.empty()) return arguments.out;
  return study.out.value_or(fs::path("out") / arguments.study.stem());
}

bool is_finished(const Study& study, const Job& job, const fs::path& folder) {
  const auto record = record_of(study, job, JobFiles(folder, job.id));
  return record && !record->failure;
}

// Throws InputError if the job would remove an input or a folder that no study made.
void check_results_folder(const Job& job, const fs::path& folder) {
  const JobFiles files(folder, job.id);
  const std::string results = fs::weakly_canonical(files.results).string() + '/';
  for (const fs::path& input : job.inputs) {
    if (!fs::weakly_canonical(input).string().starts_with(results)) continue;
    throw InputError(
        fmt::format("{}: is an input in the folder of its own results; choose another "
                    "folder with --out",
                    input.string()));
  }
  if (fs::exists(files.results) && !fs::exists(files.config)) {
    throw InputError(files.results.string() +
                     ": exists and is not from a study; remove it or choose another folder with "
                     "--out");
  }
}

// Removes the results of an earlier call; the record first, so that no record outlives its results.
void prepare_job(const Job& job, const JobFiles& files) {
  fs::remove(files.record);
  fs::remove_all(files.results);
  fs::remove_all(fs::path(files.results) += ".part");  // of a killed simulation
  write_file(files.config, job.config_yaml);
}

class Progress {
 public:
  explicit Progress(std::size_t jobs) : jobs_(jobs) {}

  void report(const Job& job, const ProcessEnd& end) {
    ++ended_;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    const auto ended = static_cast<double>(ended_);
    const double left_s = elapsed.count() / ended * (static_cast<double>(jobs_) - ended);
    fmt::print(stderr, "[{}/{}] {}  {:.1f} s, {:.0f} s left{}\n", ended_, jobs_, job.id, end.wall_s,
               left_s, end.failure ? "; failed: " + *end.failure : "");
  }

 private:
  std::size_t jobs_;
  std::size_t ended_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void run_jobs(const Study& study, const std::vector<Job>& pending, const fs::path& folder,
              int requested) {
  std::vector<ProcessCommand> commands;
  for (const Job& job : pending) {
    const JobFiles files(folder, job.id);
    commands.push_back({.arguments = arguments_of(study, files), .messages = files.messages});
  }
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  Progress progress(pending.size());
  run_processes(
      commands, requested > 0 ? requested : cores,
      [&](std::size_t i) { prepare_job(pending[i], JobFiles(folder, pending[i].id)); },
      [&](std::size_t i, const ProcessEnd& end) {
        write_job_record(JobFiles(folder, pending[i].id).record,
                         {.hash = pending[i].hash, .failure = end.failure, .wall_s = end.wall_s});
        progress.report(pending[i], end);
      });
}

void write_results(const BatchArguments& arguments, const fs::path& folder,
                   const nlohmann::json& results) {
  const StudyReportContent page{.title = arguments.study.string(),
                                .study_yaml = read_text_file(arguments.study),
                                .overrides = arguments.overrides};
  write_files(folder, {{"study.csv", study_csv(results)},
                       {"study.json", json_text(results) + '\n'},
                       {"study.html", study_report_html(page, results)}});
  for (const std::string& problem : unknown_metrics(results)) {
    fmt::print(stderr, "stillkite: {}\n", problem);
  }
}

void batch(const BatchArguments& arguments) {
  Study study = read_study(arguments.study, arguments.overrides);
  select_configurations(study, arguments.only);
  const fs::path folder = study_folder(arguments, study);
  const bool is_shard = !arguments.shard.empty();
  const std::vector<Job> jobs = make_jobs(study, file_digest("/proc/self/exe"),
                                          is_shard ? read_shard(arguments.shard) : Shard{});
  if (arguments.list) {
    for (const Job& job : jobs) {
      fmt::print("{} {}\n", is_finished(study, job, folder) ? "finished" : "pending ", job.id);
    }
    return;
  }
  for (const Job& job : jobs) check_results_folder(job, folder);
  prepare_output_folder(folder / "jobs", 0);
  const FolderLock lock(folder, is_shard ? WhenLocked::share : WhenLocked::reject);
  std::vector<Job> pending;
  std::ranges::copy_if(jobs, std::back_inserter(pending),
                       [&](const Job& job) { return !is_finished(study, job, folder); });
  run_jobs(study, pending, folder, arguments.jobs);
  const auto finished =
      std::ranges::count_if(jobs, [&](const Job& job) { return is_finished(study, job, folder); });
  const std::string count = fmt::format("{} of {} jobs finished, {} of them before\n", finished,
                                        jobs.size(), jobs.size() - pending.size());
  if (is_shard) {
    fmt::print("{}", count);
    if (interrupted()) throw Interrupted{};
    return;
  }
  const nlohmann::json results = study_json(study, jobs, folder);
  write_results(arguments, folder, results);
  if (arguments.json) {
    fmt::print("{}\n", json_text(results));
  } else {
    fmt::print("{}{}report       {}\n", study_table(results), count,
               (folder / "study.html").string());
  }
  if (interrupted()) throw Interrupted{};
  if (const std::size_t failed = jobs.size() - static_cast<std::size_t>(finished); failed > 0) {
    throw std::runtime_error(fmt::format("{} of {} jobs failed; messages: {}, next call: retried",
                                         failed, jobs.size(), (folder / "jobs/*.txt").string()));
  }
}

}  // namespace

void add_batch(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "batch", "Run a study: flights x configurations x seeds, on all cores, resumable");
  const auto arguments = std::make_shared<BatchArguments>();
  command->add_option("study", arguments->study, "YAML file, such as bench/studies/recordings.yaml")
      ->required();
  add_overrides(*command, arguments->overrides);
  command->add_option("--out", arguments->out, "Folder for the results (default: out/STUDY)")
      ->type_name("DIR");
  command->add_option("--only", arguments->only, "Comma-separated configurations (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAMES");
  command
      ->add_option("--shard", arguments->shard,
                   "Run the K-th of N parts of the jobs, without table and page; see below")
      ->type_name("K/N");
  command->add_option("--jobs", arguments->jobs, "Number of parallel jobs (default: one per core)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--list", arguments->list, "Print the jobs and exit");
  command->add_flag("--json", arguments->json, "Print only study.json on stdout");
  command->footer(
      "Keys of a study: command (run, compare, hover, simulate), flights (configuration files,\n"
      "patterns, or name: file), configurations (name: {key: value}), seeds (list or\n"
      "{first, count}), settings (keys of all jobs), estimators (of compare), metrics, out.\n"
      "Writes study.csv, study.json, study.html and, in jobs/, the results of each job. A job "
      "that\n"
      "has finished with the same program, configuration and inputs does not run again; a failed\n"
      "one does. Exit status 1 if a job failed.\n"
      "Shards of one study run at the same time, on several computers (deploy/Snakefile: Slurm).\n"
      "Exit status 0 when each job of the shard has ended; the call without --shard then writes\n"
      "table and page.");
  command->callback([arguments] { batch(*arguments); });
}

}  // namespace stillkite
