// What explains measured modes: 04_diagnose machine.toml modes.csv
#include <cstdio>
#include <hydrapod/hydrapod.hpp>
using namespace hydrapod;

int main(int count, char** arguments) {
  if (count < 3) return 2;
  const auto machine = tasks::read_machine({.file = arguments[1]});
  const auto found = tasks::diagnose(machine, {.measured = {.files = {arguments[2]}}});
  const auto& diagnosis = *found.file.diagnosis;
  for (const auto& one : diagnosis.hypotheses)
    std::printf("%9.1f  %s\n", one.bic, report::hypothesis_name(diagnosis, one).c_str());
}
