#include "hydrapod/command.hpp"

#include <sys/stat.h>

#include <algorithm>

#include "hydrapod/base/text.hpp"
#include "hydrapod/studio/plans.hpp"
#include "hydrapod/studio/studio.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  std::string file{};
  std::vector<std::string> records{}, overrides{}, poses{};
  std::string model{};
  std::string address{}, key{};
  int port{};
  bool no_browser{};
};

/// A secret of at least 128 bits that others on this computer cannot read.
std::string key_in(const std::string& path) {
  constexpr std::size_t shortest = 22, longest = 128;
  struct stat found {};
  if (::stat(path.c_str(), &found) == 0 && (found.st_mode & 077U) != 0)
    base::refuse(path,
                 "other users may read or write the key; expected the mode 600 "
                 "(chmod 600)");
  const std::string text(base::trimmed(base::read_file(path, 4096, "a key of one line")));
  const auto fits = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
           c == '_';
  };
  if (text.size() < shortest || text.size() > longest || !std::ranges::all_of(text, fits))
    base::refuse(path, fmt::format("expected one line of {} to {} letters, digits, - and _, for "
                                   "instance from: openssl rand -hex 16",
                                   shortest, longest));
  return text;
}

studio::ServerOptions server_options(const Arguments& a) {
  studio::ServerOptions options{.port = static_cast<std::uint16_t>(a.port)};
  if (a.address.empty() != a.key.empty())
    base::refuse(a.address.empty() ? "--key" : "--bind",
                 a.address.empty() ? "needs --bind ADDRESS: without it the studio listens on the "
                                     "loopback only, with a key of its own"
                                   : "needs --key FILE: who reaches this address and knows the key "
                                     "can run the program");
  options.key = a.key.empty() ? studio::random_key() : key_in(a.key);
  if (!a.address.empty()) options.address = a.address;
  return options;
}

void run(const Arguments& a) {
  // gcc 12 destroys members that were not yet made where one of a braced list throws
  auto server = server_options(a);
  studio::StudioOptions options;
  options.server = std::move(server);
  options.browser = !a.no_browser;
  options.program = "/proc/self/exe";  // also where the file was replaced meanwhile
  if (a.file == "-") base::refuse("-", "the studio edits a file; give the path of one");
  if (!a.file.empty()) options.machine.file = studio::absolute_path(a.file, "FILE");
  options.machine.overrides = a.overrides;
  if (!a.poses.empty()) options.machine.poses = a.poses;
  options.machine.model = model_kind(a.model);
  for (const auto& record : a.records)
    options.records.push_back(studio::absolute_path(record, "RECORD"));
  studio::serve(std::move(options));
}

constexpr const char* after =
    "\n\nThe address that it prints has a random key. Only this computer can reach it. Whoever "
    "knows "
    "the\naddress can read and write files as you can: pass it on to nobody.";

}  // namespace

void add_studio(Command app) {
  Command command = app.add_command(
      "studio", "The report as a page with the program behind it: sliders, jobs, records, saving",
      {{"studio machine.toml", "opens the browser; Ctrl-C ends it"},
       {"studio machine.toml run.h5 --no-browser", "with a record, and the address only"},
       {"studio", "begins with a new machine"}},
      after);
  auto& arguments = command.calls(&run);
  command.add_options(
      {{"FILE", arguments.file, "Machine file (TOML) [a new machine]", reads},
       {"RECORD", arguments.records, "Measured files for the list of records", reads},
       {"--set", arguments.overrides,
        "PATH=VALUE overrides a value of the file, units allowed; may be repeated",
        one_each_as("PATH=VALUE")},
       {"--pose", arguments.poses,
        "Pose of the file, or displacements from the neutral pose: \"z=50 mm, ry=5 deg\"; may be "
        "repeated [neutral]",
        one_each_as("POSE")},
       {"--port", arguments.port, "Port; 0: any that is free", range(0, 65535)},
       {"--bind", arguments.address,
        "Listen at this address of the computer, not at the loopback; needs --key",
        shown_as("ADDRESS")},
       {"--key", arguments.key,
        "File with the key of the address, for --bind: 22 or more letters and digits, mode 600",
        reads}});
  command.add_options({{"--model", arguments.model, "rigid, guide or full, as in hydrapod modes",
                        shown_as("MODEL")},
                       {"--no-browser", arguments.no_browser, "Do not open a browser"}});
}

}  // namespace hydrapod::cli
