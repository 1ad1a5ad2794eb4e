#include "models.hpp"

std::string model_file(const std::string& name) { return std::string(HYDRAPOD_MODELS "/") + name; }
