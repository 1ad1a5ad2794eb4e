#include "hydrapod/studio/studio.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <spawn.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstring>
#include <filesystem>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/output_files.hpp"
#include "hydrapod/reproduction.hpp"
#include "hydrapod/studio/plans.hpp"
#include "hydrapod/studio/studio_json.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::studio {

namespace {
namespace asio = boost::asio;
namespace fs = std::filesystem;
using report::Json;
using Failure = boost::system::error_code;
using std::chrono::milliseconds;

constexpr std::string_view of_jobs = "job/", of_cancel = "cancel/";

/// The page for the browser is named in a file of this user: a command line can be read by others.
void open_browser(const std::string& url, const std::string& folder) {
  const auto file = folder + "/open.html";
  base::write_file_whole(
      file, fmt::format("<!DOCTYPE html>\n<meta http-equiv=\"refresh\" content=\"0;url={}\">\n"
                        "<a href=\"{}\">hydrapod studio</a>\n",
                        url, url));
  std::string program = "xdg-open", name = file;
  std::array<char*, 3> words{program.data(), name.data(), nullptr};
  posix_spawn_file_actions_t silent;
  ::posix_spawn_file_actions_init(&silent);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    ::posix_spawn_file_actions_addopen(&silent, stream, "/dev/null", O_RDWR, 0);
  pid_t process = 0;
  const int failure =
      ::posix_spawnp(&process, program.c_str(), &silent, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&silent);
  if (failure != 0)
    cli::print_note(fmt::format("no browser was opened (xdg-open: {}); open the address above",
                                std::strerror(failure)));
}

MachineChoice with_file(MachineChoice choice, TemporaryFolder& folder) {
  if (!choice.file.empty()) return choice;
  choice.file = folder.place_for("machine.toml");
  choice.is_new = true;
  base::write_file_whole(choice.file, model::starter_machine_file());
  return choice;
}

/// What a person may be told of a request that is no JSON, or not that which is expected.
Json read_json(const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) base::refuse("request", "expected a JSON object");
  return json;
}

class Studio : public Site {
 public:
  explicit Studio(StudioOptions options)
      : options_(std::move(options)),
        machine_(with_file(options_.machine, folder_)),
        records_(folder_),
        jobs_(context_, options_.program, [this](const Job& job) { changed(job); }),
        signals_(context_, SIGINT, SIGTERM),
        watch_(context_),
        end_(context_),
        server_(context_, options_.server, *this) {
    for (const auto& path : options_.records) records_.add(path);
  }

  void run() {
    (void)page();  // a program without the page says so now
    const auto host = options_.server.address.find(':') == std::string::npos
                          ? options_.server.address
                          : "[" + options_.server.address + "]";
    const auto url = fmt::format("http://{}:{}/{}/", host, server_.port(), options_.server.key);
    base::write_file_whole("-", url + "\n");
    cli::print_note("Ctrl-C ends the studio");
    if (options_.browser) open_browser(url, folder_.path());
    wait_for_signal();
    watch();
    context_.run();
  }

  Response answer(const Request& request) override {
    try {
      return request.posts ? post(request) : get(request.path);
    } catch (const Json::exception& error) {
      base::refuse("request", error.what());
    }
  }

  std::variant<std::string, Response> upload_place(const Request& head) override {
    if (!head.posts || head.path != "record") return std::string();
    try {
      return records_.place_for(decoded(head.query));
    } catch (const base::InputError& error) {
      return Response{422, text({{"error", error.what()}})};
    }
  }

  Response uploaded(const Request& head, const std::string& place) override {
    const auto number = records_.arrived(decoded(head.query), place);
    tell_state();
    return {200, Json{{"number", number}}.dump()};
  }

  void upload_failed(const std::string& place) override { records_.discard(place); }

  std::string greeting() override { return text({{"state", state()}}); }

 private:
  Response get(const std::string& path) {
    if (path.empty()) return {200, page(), "text/html; charset=utf-8"};
    if (path == "state") return {200, text(state())};
    if (path == "edits") return {200, text(edits_json(machine_.edits()))};
    if (path.starts_with(of_jobs)) {
      const auto job = jobs_.find(number_in(path.substr(of_jobs.size())));
      if (job) return {200, text(whole_job_json(*job))};
    }
    return {404, Json{{"error", "not found"}}.dump()};
  }

  Response post(const Request& request) {
    const auto& path = request.path;
    if (path.starts_with(of_cancel)) {
      const bool found = jobs_.cancel(number_in(path.substr(of_cancel.size())));
      return {found ? 200U : 404U, Json{{"cancelled", found}}.dump()};
    }
    if (path == "reload") {
      machine_.reload();
      return new_page();
    }
    if (path != "values" && path != "save" && path != "page" && path != "job")
      return {404, Json{{"error", "not found"}}.dump()};
    const auto asked = read_json(request.body);
    if (path == "values") return take_values(asked);
    if (path == "job") return start_job(asked);
    const auto replace = asked.value("replace", false);
    auto target = asked.value("path", std::string());
    if (path == "page") return save_page(absolute_path(target, "path"), replace);
    if (!target.empty()) target = absolute_path(target, "path");
    if (!target.empty() && !target.ends_with(".toml"))
      base::refuse(target, "a machine file ends in .toml");
    machine_.save(target, replace);
    differs_ = false;
    return new_page();
  }

  Response take_values(const Json& asked) {
    auto change = values_in(asked);
    machine_.change(std::move(change.values), std::move(change.assignments));
    values_by_ = change.from;
    ++values_number_;
    tell_state();
    return {200, Json{{"number", values_number_}}.dump()};
  }

  Response start_job(const Json& asked) {
    if (machine_.differs_on_disk())
      base::refuse(machine_.file(),
                   "the file on the disk has changed since it was read; read it again, then start "
                   "the job");
    auto plan = job_plan(asked, {machine_, records_, folder_});
    return {200, Json{{"id", jobs_.start(std::move(plan))}}.dump()};
  }

  Response new_page() {
    ++page_number_;
    page_.clear();
    tell_state();
    return {200, Json{{"page", page_number_}}.dump()};
  }

  /// A result for a section of the page; the pages load themselves again.
  void changed(const Job& job) {
    if (job.state == JobState::done && !job.plan.section.empty() && job.result.is_object()) {
      const auto& section = job.plan.section;
      sections_[section] = job.result.contains(section) ? job.result.at(section) : job.result;
      ++page_number_;
      page_.clear();
    }
    if (job.is_over() || job.state == JobState::waiting) return tell_state();
    server_.tell(Json{{"job", job_json(job)}}.dump(-1, ' ', false, Json::error_handler_t::replace));
  }

  Json document(bool pages) {
    const auto machine = machine_.machine(0, pages);
    tasks::ReportOptions options;
    for (std::size_t k = 0; k < machine_.poses(); ++k)
      options.poses.push_back(tasks::pose_of(machine.file.machine, machine_.pose(k)));
    auto made = tasks::report_document(machine, options).document;
    made["reproduction"] = cli::reproduction();
    for (const auto& [name, section] : sections_.items()) made[name] = section;
    return made;
  }

  const std::string& page() {
    if (!page_.empty()) return page_;
    auto made = document(false);
    made["studio"] = {{"page", page_number_}};
    page_ = report::html_page(made);
    return page_;
  }

  Response save_page(const std::string& path, bool replace) {
    cli::require_ending("the page", path, ".html");
    refuse_existing(path, replace);
    base::write_file_whole(path, report::html_page(document(true)));
    return {200, text({{"written", path}})};
  }

  Json state() {
    std::error_code gone;
    Json json{{"page", page_number_},
              {"file", machine_.is_new() ? "" : machine_.file()},
              {"folder", fs::current_path(gone).string()},
              {"differs_on_disk", differs_},
              {"changed", machine_.is_changed()},
              {"values", machine_.values()},
              {"values_number", values_number_},
              {"values_by", values_by_},
              {"records", records_.json()},
              {"jobs", Json::array()}};
    for (const auto& job : jobs_.all()) json["jobs"].push_back(job_json(*job));
    return json;
  }

  void tell_state() { server_.tell(text({{"state", state()}})); }

  static std::string text(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

  /// The first Ctrl-C lets the jobs keep what they have, the second one does not wait for that.
  void wait_for_signal() {
    signals_.async_wait([this](Failure failure, int) {
      if (failure) return;
      if (stopping_) return context_.stop();
      stopping_ = true;
      server_.stop();
      watch_.cancel();
      jobs_.stop();
      wait_for_jobs(200);
      wait_for_signal();
    });
  }

  void wait_for_jobs(int left) {
    if (left == 0 || !jobs_.any_running()) return context_.stop();
    end_.expires_after(milliseconds(10));
    end_.async_wait([this, left](Failure) { wait_for_jobs(left - 1); });
  }

  void watch() {
    watch_.expires_after(milliseconds(1000));
    watch_.async_wait([this](Failure failure) {
      if (failure) return;
      if (const bool differs = machine_.differs_on_disk(); differs != differs_) {
        differs_ = differs;
        tell_state();
      }
      watch();
    });
  }

  StudioOptions options_;
  TemporaryFolder folder_;
  asio::io_context context_{1};
  OpenMachine machine_;
  Records records_;
  Jobs jobs_;
  asio::signal_set signals_;
  asio::steady_timer watch_, end_;
  Server server_;
  Json sections_ = Json::object();
  std::string page_, values_by_;
  int page_number_{1}, values_number_{};
  bool differs_{}, stopping_{};
};

}  // namespace

void serve(StudioOptions options) {
  ::signal(SIGPIPE, SIG_IGN);
  Studio(std::move(options)).run();
}

}  // namespace hydrapod::studio
