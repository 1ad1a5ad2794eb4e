#pragma once
/// The script that a picture is drawn by.

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/run_program.hpp"

namespace hydrapod::test {

/// What `draw` gives to gnuplot, of which a program of that name keeps a copy.
template <class Draw>
std::string script_of(const Draw& draw) {
  const TemporaryFolder folder;
  const std::string kept = (folder / "kept").string();
  write_text(folder / "gnuplot", "#!/bin/sh\ncp \"$1\" '" + kept + "'\n");
  std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
  const std::string before = std::getenv("PATH");
  setenv("PATH", (folder.path().string() + ":" + before).c_str(), 1);
  draw((folder / "picture.svg").string());
  setenv("PATH", before.c_str(), 1);
  return read_text(kept);
}

}  // namespace hydrapod::test
