#pragma once
/// MAT files and their variables as matio holds them, which close and free themselves.

#include <matio.h>

#include <memory>

namespace hydrapod::test {

struct CloseMat {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFile = std::unique_ptr<mat_t, CloseMat>;
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

}  // namespace hydrapod::test
