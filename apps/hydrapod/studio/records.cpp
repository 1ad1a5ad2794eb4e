#include "hydrapod/studio/records.hpp"

#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::studio {

namespace {
namespace fs = std::filesystem;

/// As a file may be called in any folder.
std::string harmless(const std::string& name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  };
  std::string result = name.substr(name.find_last_of("/\\") + 1);
  if (result.size() > 80) result = result.substr(result.size() - 80);
  std::ranges::replace_if(result, [&](char c) { return !allowed(c); }, '_');
  while (result.starts_with('.') || result.starts_with('-')) result.erase(0, 1);
  return result.empty() ? "record" : result;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::error_code failure;
  const auto folder = fs::temp_directory_path(failure);
  std::string pattern = (failure ? fs::path("/tmp") : folder) / "hydrapod-studio-XXXXXX";
  if (::mkdtemp(pattern.data()) == nullptr)
    base::refuse(pattern, fmt::format("no temporary folder: {}", std::strerror(errno)));
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string TemporaryFolder::place_for(const std::string& name) {
  const auto folder = fs::path(path_) / std::to_string(++count_);
  if (::mkdir(folder.c_str(), 0700) != 0)
    base::refuse(folder.string(), fmt::format("no folder: {}", std::strerror(errno)));
  return (folder / name).string();
}

std::string Records::place_for(const std::string& name) {
  std::uint64_t bytes = 0;
  std::error_code failure;
  for (const auto& one : all_)
    if (const auto size = fs::file_size(one.path, failure); !one.given && !failure) bytes += size;
  if (all_.size() >= most)
    base::refuse(base::printable(name), fmt::format("there are {} records already", all_.size()));
  if (bytes >= most_bytes)
    base::refuse(base::printable(name),
                 fmt::format("the records sent so far take {} MiB already; start the studio with "
                             "the file's path instead",
                             bytes >> 20U));
  return folder_.place_for(harmless(name));
}

std::size_t Records::arrived(const std::string& name, const std::string& place) {
  all_.push_back({place, base::printable(name, 200), false});
  return all_.size() - 1;
}

void Records::discard(const std::string& place) {
  std::error_code ignored;
  fs::remove(place, ignored);
}

report::Json Records::json() const {
  report::Json json = report::Json::array();
  for (std::size_t k = 0; k < all_.size(); ++k)
    json.push_back({{"number", k}, {"name", all_[k].name}, {"given", all_[k].given}});
  return json;
}

}  // namespace hydrapod::studio
