#pragma once

#include <string>

/// The path of a file of models/. Only models.cpp knows the place of the repository: the compiler
/// cache serves all other files in another checkout too.
std::string model_file(const std::string& name);
