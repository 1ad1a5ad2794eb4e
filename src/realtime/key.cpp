/// Secrets and addresses.

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/realtime/realtime.hpp"

namespace hydrapod::realtime {

namespace {
constexpr std::size_t shortest_key = 16, longest_key = 4096;
}

Key read_key(const std::string& path) {
  struct stat status {};
  if (path != "-" && ::stat(path.c_str(), &status) == 0 && (status.st_mode & 077) != 0)
    base::refuse(path, fmt::format("can be read or written by others (mode {:04o}), expected the "
                                   "owner alone: chmod 600",
                                   status.st_mode & 07777));
  Key key{base::read_file(path, longest_key, "a key")};
  if (key.bytes.size() < shortest_key)
    base::refuse(path, fmt::format("has {} bytes, expected {} to {} random ones: head -c 32 "
                                   "/dev/urandom > FILE",
                                   key.bytes.size(), shortest_key, longest_key));
  return key;
}

Address parse_address(const std::string& place, const std::string& text) {
  Address address;
  std::string_view rest = base::trimmed(text);
  if (const auto end = rest.find("]:"); rest.starts_with('[') && end != rest.npos) {
    address.host = rest.substr(1, end - 1);
    rest.remove_prefix(end + 2);
  } else if (const auto colon = rest.find(':');
             colon != rest.npos && rest.find(':', colon + 1) == rest.npos) {
    address.host = rest.substr(0, colon);
    rest.remove_prefix(colon + 1);
  }
  const bool digits = !rest.empty() && rest.size() <= 5 &&
                      std::ranges::all_of(rest, [](char c) { return c >= '0' && c <= '9'; });
  if (!digits || std::stoi(std::string(rest)) > 65535 || address.host.empty())
    base::refuse(place, fmt::format("is \"{}\", expected a port from 0 to 65535, or ADDRESS:PORT "
                                    "such as 127.0.0.1:4747 or [::1]:4747",
                                    base::printable(text)));
  address.port = rest;
  return address;
}

}  // namespace hydrapod::realtime
