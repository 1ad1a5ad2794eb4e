#pragma once
/// Studies and designs as JSON and pictures.

#include <string>

#include "hydrapod/report/json.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::report {

/// `rows`, `rows_planned`, `complete`, `seed`, `inputs[]`, `statuses`, `outputs[]` with mean,
/// deviation and quantiles, `requirements[]` with the probability of missing them and its interval,
/// `indices[]` where they were asked for.
Json study_json(const study::Problem& problem, const study::Plan& plan,
                const std::vector<study::Requirement>& requirements, const study::Summary& summary);

/// A value over two inputs that form a grid, the second one fastest; NaN: no value.
struct Field {
  std::string x_name{}, y_name{};  ///< with units
  std::vector<double> x{}, y{};
  std::string name{};  ///< of the value, with its unit
  std::vector<double> values{};
};

/// Heat map with contours; where there is no value the plane is grey.
void plot_field(const Field& field, const std::string& title, const std::string& subtitle,
                const std::string& path);

/// `feasible`, `evaluations`, `changes[]`, `aims[]`, `requirements[]` with what can be reached,
/// `limits[]` with prices, `front[]` of two aims.
Json design_json(const study::DesignProblem& problem, const study::DesignResult& result);

/// The curve of two aims.
void plot_trade_off(const study::DesignProblem& problem, const study::DesignResult& result,
                    const std::string& title, const std::string& subtitle, const std::string& path);

/// Per change, what each requirement has to spare where this change alone differs from the design;
/// the design is a dashed line, what misses a requirement is grey.
void plot_design_slices(const study::DesignProblem& problem, const study::DesignResult& result,
                        const std::vector<study::Slice>& slices, const std::string& title,
                        const std::string& subtitle, const std::string& path);

}  // namespace hydrapod::report
