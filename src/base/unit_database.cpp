#include "unit_database.hpp"

#include <locale.h>
#include <udunits2.h>

#include <memory>
#include <mutex>
#include <stdexcept>

namespace hydrapod::base {

namespace {

/// UDUNITS-2 reads numbers with strtod, in whatever locale the program is in.
class ClassicLocale {
 public:
  ClassicLocale() : previous_(uselocale(classic())) {}
  ~ClassicLocale() { uselocale(previous_); }
  ClassicLocale(const ClassicLocale&) = delete;
  ClassicLocale& operator=(const ClassicLocale&) = delete;

 private:
  static locale_t classic() {
    static const locale_t locale = newlocale(LC_ALL_MASK, "C", nullptr);
    return locale;
  }
  locale_t previous_;
};

/// UDUNITS-2 writes to stderr on its own account otherwise.
class SilentUdunits {
 public:
  SilentUdunits() : previous_(ut_set_error_message_handler(ut_ignore)) {}
  ~SilentUdunits() { ut_set_error_message_handler(previous_); }
  SilentUdunits(const SilentUdunits&) = delete;
  SilentUdunits& operator=(const SilentUdunits&) = delete;

 private:
  ut_error_message_handler previous_;
};

struct FreeSystem {
  void operator()(ut_system* system) const { ut_free_system(system); }
};
struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using UnitPointer = std::unique_ptr<ut_unit, FreeUnit>;

/// The database lacks the abbreviation "deg".
void add_degree_symbol(ut_system* system) {
  const UnitPointer degree{ut_get_unit_by_name(system, "degree")};
  if (degree) ut_map_symbol_to_unit("deg", UT_ASCII, degree.get());
}

ut_system* database() {
  static std::unique_ptr<ut_system, FreeSystem> system;
  if (!system) {
    system.reset(ut_read_xml(nullptr));
    if (!system) {
      throw std::runtime_error(
          "the unit database of UDUNITS-2 cannot be read; it is in the Debian package "
          "libudunits2-data, and UDUNITS2_XML_PATH may name it");
    }
    add_degree_symbol(system.get());
  }
  return system.get();
}

const char* base_symbol(const ut_unit* unit) {
  const char* symbol = ut_get_symbol(unit, UT_ASCII);
  return symbol != nullptr ? symbol : ut_get_name(unit, UT_ASCII);
}

Unit& described(void* unit) { return *static_cast<Unit*>(unit); }

ut_status visit_basic(const ut_unit* unit, void* result) {
  described(result).dimension[base_symbol(unit)] = 1;
  return UT_SUCCESS;
}

ut_status visit_product(const ut_unit* /*unit*/, int count, const ut_unit* const* units,
                        const int* powers, void* result) {
  for (int i = 0; i < count; ++i) described(result).dimension[base_symbol(units[i])] = powers[i];
  return UT_SUCCESS;
}

ut_status visit_scaled(const ut_unit* unit, double factor, const ut_unit* underlying, double offset,
                       void* result);

ut_status visit_timestamp(const ut_unit* /*unit*/, const ut_unit* /*time*/, double /*origin*/,
                          void* result) {
  described(result).kind = UnitKind::timestamp;
  return UT_SUCCESS;
}

ut_status visit_logarithmic(const ut_unit* /*unit*/, double /*base*/, const ut_unit* /*reference*/,
                            void* result) {
  described(result).kind = UnitKind::logarithmic;
  return UT_SUCCESS;
}

constexpr ut_visitor visitor{visit_basic, visit_product, visit_scaled, visit_timestamp,
                             visit_logarithmic};

ut_status visit_scaled(const ut_unit* /*unit*/, double factor, const ut_unit* underlying,
                       double offset, void* result) {
  described(result).factor *= factor;
  if (offset != 0.0) described(result).kind = UnitKind::offset;
  return ut_accept_visitor(underlying, &visitor, result);
}

}  // namespace

std::optional<Unit> find_unit(const std::string& text) {
  static std::mutex mutex;  // UDUNITS-2 keeps parser state and status in globals
  const std::lock_guard lock(mutex);
  const ClassicLocale classic_locale;
  const SilentUdunits silent;
  const UnitPointer parsed{ut_parse(database(), text.c_str(), UT_UTF8)};
  if (!parsed) return std::nullopt;
  Unit unit;
  if (ut_accept_visitor(parsed.get(), &visitor, &unit) != UT_SUCCESS) return std::nullopt;
  return unit;
}

}  // namespace hydrapod::base
