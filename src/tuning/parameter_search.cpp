#include "tuning/parameter_search.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <nlopt.hpp>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr double kClosestPoints = 1e-3;  // on every axis
constexpr int kCallsPerEvaluation = 50;  // ends a search that finds nothing new

class Search {
 public:
  Search(const ParameterSpace& space, const StereoOptions& start, const Objective& objective,
         const SearchProgress& progress)
      : space_(space),
        objective_(objective),
        progress_(progress),
        best_{start, std::numeric_limits<double>::infinity()} {
    evaluate(start);
  }

  const SearchPoint& best() const { return best_; }

  /// Continues from the best point until `evaluations` is reached or there is no further
  /// improvement.
  void minimize(nlopt::algorithm algorithm, int evaluations) {
    limit_ = evaluations;
    nlopt::opt optimizer(algorithm, static_cast<unsigned>(space_.dimensions()));
    optimizer.set_lower_bounds(0.0);
    optimizer.set_upper_bounds(1.0);
    optimizer.set_initial_step(space_.firstSteps());
    optimizer.set_xtol_abs(kClosestPoints);
    optimizer.set_maxeval(kCallsPerEvaluation * evaluations);
    optimizer.set_min_objective(
        [](const std::vector<double>& point, std::vector<double>&, void* search) {
          return static_cast<Search*>(search)->scoreAt(point);
        },
        this);
    std::vector<double> point = space_.coordinates(best_.options);
    double score = 0;
    try {
      optimizer.optimize(point, score);
    } catch (const nlopt::forced_stop&) {       // thrown by scoreAt
    } catch (const nlopt::roundoff_limited&) {  // converged to machine precision
    }
    if (failure_ != nullptr) {
      std::rethrow_exception(failure_);
    }
  }

 private:
  /// Ends the search by forced_stop, the only exception that NLopt passes on.
  double scoreAt(const std::vector<double>& point) {
    const StereoOptions options = space_.optionsAt(point, best_.options);
    const auto known = scores_.find(describeOptions(options));
    if (known != scores_.end()) {
      return known->second;
    }
    if (evaluations_ >= limit_) {
      throw nlopt::forced_stop();
    }
    try {
      return evaluate(options);
    } catch (...) {
      failure_ = std::current_exception();
      throw nlopt::forced_stop();
    }
  }

  double evaluate(const StereoOptions& options) {
    const SearchPoint here{options, objective_(options)};
    scores_[describeOptions(options)] = here.score;
    if (here.score < best_.score) {
      best_ = here;
    }
    progress_(++evaluations_, here, best_);
    return here.score;
  }

  const ParameterSpace& space_;
  const Objective& objective_;
  const SearchProgress& progress_;
  SearchPoint best_;
  std::map<std::string, double> scores_;  ///< keyed by the options as text
  int evaluations_ = 0;
  int limit_ = 1;
  std::exception_ptr failure_;
};

}  // namespace

SearchPoint searchParameters(const ParameterSpace& space, const StereoOptions& start,
                             const Objective& objective, const SearchSettings& settings,
                             const SearchProgress& progress) {
  if (settings.evaluations < 1 || settings.global_evaluations < 0) {
    throw Error(
        "the numbers of evaluations are invalid, expected at least one evaluation and no negative "
        "number of global ones");
  }
  nlopt::srand(static_cast<unsigned long>(settings.seed));
  Search search(space, start, objective, progress);
  const int global_end = std::min(1 + settings.global_evaluations, settings.evaluations);
  if (global_end > 1) {
    search.minimize(nlopt::GN_DIRECT_L_RAND, global_end);
  }
  if (settings.evaluations > global_end) {
    search.minimize(nlopt::LN_SBPLX, settings.evaluations);
  }
  return search.best();
}

}  // namespace cbmv
