#pragma once
/// What the file of every command needs.

#include <fmt/format.h>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/output_files.hpp"
#include "hydrapod/terminal.hpp"
