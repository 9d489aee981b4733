// Measures every stage, the whole method and OpenCV's matchers on the same pairs, and checks the
// results. Flags: those of Google Benchmark and of --help.

#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <benchmark/benchmark.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <tbb/task_arena.h>

#include "checks.h"
#include "evaluation/rendered_poles.h"
#include "machine.h"
#include "pipelines.h"
#include "problem.h"
#include "stages.h"
#include "support/scoped_simd_target.h"
#include "tools/run_tool.h"

#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv::benchmarks {
namespace {

using benchmark::Counter;

/// Data shared between benchmarks; holds only the data of the latest problem.
class Context {
 public:
  StageData& stageData(const Problem& problem) {
    if (!data_ || problem_ != problem.name()) {
      data_.reset();
      data_ = makeStageData(problem);
      problem_ = problem.name();
    }
    return *data_;
  }

  /// Whether `result` equals the expected checksum for `name`. `make` computes the expected value
  /// on the first call.
  template <typename Make>
  bool isAsExpected(const std::string& name, std::uint64_t result, const Make& make) {
    const auto known = expected_.find(name);
    return result == (known != expected_.end() ? known->second : expected_[name] = make());
  }

 private:
  std::string problem_;
  std::shared_ptr<StageData> data_;
  std::map<std::string, std::uint64_t> expected_;
};

int allThreads() { return static_cast<int>(std::thread::hardware_concurrency()); }

std::uint64_t checksum(const cv::Mat& map) {
  Checksum sum;
  sum.add(map);
  return sum.value();
}

std::uint64_t runStage(const Stage& stage, StageData& data, int threads) {
  tbb::task_arena(threads).execute([&] { stage.run(data); });
  Checksum sum;
  stage.add_result(data, sum);
  return sum.value();
}

/// The result with two threads and another instruction set.
std::uint64_t otherResult(const Stage& stage, StageData& data) {
  const test::ScopedSimdTarget scope(realSimdTargets().back());
  return runStage(stage, data, 2);
}

/// Time per unit in nanoseconds, as a counter.
Counter nanoseconds(double units) {
  return {units * 1e-9, Counter::kIsIterationInvariantRate | Counter::kInvert};
}

void timeStage(benchmark::State& state, const Stage& stage, const Problem& problem,
               Context& context) {
  StageData& data = context.stageData(problem);
  const std::uint64_t result = runStage(stage, data, 1);
  if (!context.isAsExpected(stage.name + problem.name(), result,
                            [&] { return otherResult(stage, data); })) {
    state.SkipWithError("the result depends on the threads or on the instruction set");
    return;
  }
  tbb::task_arena(1).execute([&] {
    for (auto _ : state) {
      stage.run(data);
    }
  });
  const std::string unit = stage.unit == StageUnit::kPixels ? "pixel" : "hypothesis";
  state.counters["ns_per_" + unit] = nanoseconds(unitsOf(stage, data));
  state.counters["memory_bytes_per_" + unit] = stage.memory_bytes;
  state.counters["computed_bytes_per_" + unit] = stage.computed_bytes;
}

void addStageTimes(benchmark::State& state, const StageTimes& sum) {
  const std::vector<std::pair<const char*, double>> times = {
      {"rectification_ms", sum.rectification_ms}, {"volume_ms", sum.volume_ms},
      {"aggregation_ms", sum.aggregation_ms},     {"sgm_ms", sum.sgm_ms},
      {"refinement_ms", sum.refinement_ms},       {"selection_ms", sum.selection_ms}};
  for (const auto& [name, ms] : times) {
    state.counters[name] = Counter(ms, Counter::kAvgIterations);
  }
}

void accumulate(const StageTimes& times, StageTimes& sum) {
  sum.rectification_ms += times.rectification_ms;
  sum.volume_ms += times.volume_ms;
  sum.aggregation_ms += times.aggregation_ms;
  sum.sgm_ms += times.sgm_ms;
  sum.refinement_ms += times.refinement_ms;
  sum.selection_ms += times.selection_ms;
}

/// Settings of a run of the whole method.
struct CbmvCase {
  std::string preset;
  Problem problem;
  int threads;
  std::int64_t simd_target;  ///< 0: the best one
  bool exhaustive = false;   ///< instead of the preset's search
};

StereoOptions optionsOf(const CbmvCase& what, int threads) {
  StereoOptions options = presetOptions(what.preset, what.problem, threads);
  options.search.levels = what.exhaustive ? 0 : options.search.levels;
  return options;
}

void timeCbmv(benchmark::State& state, const CbmvCase& what, Context& context) {
  const test::ScopedSimdTarget scope(what.simd_target);
  const Pair pair = loadPair(what.problem);
  StageTimes times;
  const Method method = makeCbmv(optionsOf(what, what.threads), what.preset, what.problem, times);
  const std::uint64_t result = checksum(method(pair));  // also allocates the buffers
  const std::string name = what.preset + what.problem.name() + (what.exhaustive ? "full" : "");
  const bool is_right = context.isAsExpected(name, result, [&] {
    StageTimes unused;
    const StereoOptions options = optionsOf(what, what.threads == 1 ? 2 : 1);
    return checksum(makeCbmv(options, what.preset, what.problem, unused)(pair));
  });
  if (!is_right) {
    state.SkipWithError("the disparities depend on the threads or on the instruction set");
    return;
  }
  StageTimes sum;
  for (auto _ : state) {
    benchmark::DoNotOptimize(method(pair));
    accumulate(times, sum);
  }
  state.counters["ns_per_hypothesis"] = nanoseconds(what.problem.hypotheses());
  addStageTimes(state, sum);
}

void timeOpenCv(benchmark::State& state, const std::string& name, const Problem& problem,
                Context& context) {
  const Pair pair = loadPair(problem);
  const Method method = makeOpenCv(name, problem);
  cv::setNumThreads(allThreads());
  const std::uint64_t result = checksum(method(pair));
  if (!context.isAsExpected("opencv " + name + problem.name(), result,
                            [&] { return checksum(makeOpenCv(name, problem)(pair)); })) {
    state.SkipWithError("the disparities of two runs differ");
    return;
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(method(pair));
  }
  state.counters["ns_per_hypothesis"] = nanoseconds(problem.hypotheses());
}

void timeCopy(benchmark::State& state, int threads) {
  const std::vector<std::uint8_t> from(std::size_t{256} << 20, 1);
  std::vector<std::uint8_t> to(from.size());
  double bytes = 0;
  tbb::task_arena(threads).execute([&] {
    streamCopy(from, to);
    for (auto _ : state) {
      bytes += streamCopy(from, to);
    }
  });
  if (to != from) {
    state.SkipWithError("the copy differs");
  }
  state.counters["bytes_per_ns"] = Counter(bytes * 1e-9, Counter::kIsRate);
}

void timeComputing(benchmark::State& state) {
  double bytes = 0;
  std::uint8_t result = 255;
  for (auto _ : state) {
    bytes += computeBytes(100000, result);
    benchmark::DoNotOptimize(result);
  }
  state.counters["bytes_per_ns"] = Counter(bytes * 1e-9, Counter::kIsRate);
}

template <typename Body>
void add(const std::string& name, Body body) {
  benchmark::RegisterBenchmark(name.c_str(), body)
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}

void addMachine() {
  add("machine/compute", [](benchmark::State& state) { timeComputing(state); });
  add("machine/copy/1", [](benchmark::State& state) { timeCopy(state, 1); });
  add("machine/copy/all", [](benchmark::State& state) { timeCopy(state, allThreads()); });
}

void addStages(Context& context) {
  for (const Problem& problem : problems()) {
    for (const Stage& stage : stages()) {
      add("stage/" + stage.name + "/" + problem.name(),
          [&](benchmark::State& state) { timeStage(state, stage, problem, context); });
    }
  }
}

void addCbmv(const std::string& name, const CbmvCase& what, Context& context) {
  add(name + what.preset + "/" + what.problem.name(),
      [what, &context](benchmark::State& state) { timeCbmv(state, what, context); });
}

void addMethods(Context& context) {
  for (const Problem& problem : problems()) {
    for (const std::string& preset : presets()) {
      addCbmv("cbmv/", {preset, problem, allThreads(), 0}, context);
      addCbmv("exhaustive/", {preset, problem, allThreads(), 0, true}, context);
      for (int threads = 1; threads < 2 * allThreads(); threads *= 2) {
        const int used = std::min(threads, allThreads());
        addCbmv("threads_" + std::to_string(used) + "/", {preset, problem, used, 0}, context);
      }
      for (const std::int64_t target : realSimdTargets()) {
        addCbmv(std::string("simd_") + hwy::TargetName(target) + "/",
                {preset, problem, allThreads(), target}, context);
      }
    }
    for (const std::string& name : openCvMethods()) {
      add("opencv/" + name + "/" + problem.name(),
          [&](benchmark::State& state) { timeOpenCv(state, name, problem, context); });
    }
  }
}

/// Runs a preset on one pair. The process must do nothing else, so that its peak memory is that of
/// the preset.
void printPeakMemory(const std::string& preset, const Problem& problem) {
  const Pair pair = loadPair(problem);
  const double before = peakMemoryMib();
  StageTimes times;
  makeCbmv(presetOptions(preset, problem, allThreads()), preset, problem, times)(pair);
  std::printf("{\"peak_mib\": %.0f, \"before_mib\": %.0f}\n", peakMemoryMib(), before);
}

/// Fraction of the pixels on thin poles that a preset finds, with exhaustive search and with its
/// own search.
void printPoles(const std::string& preset) {
  nlohmann::json rows;
  for (const auto& [far_px, near_px] : {std::pair(4, 24), std::pair(4, 48), std::pair(10, 20)}) {
    const RenderedPoles poles = renderPoles(far_px, near_px, 1);
    StereoOptions options = presetOptions(preset, {poles.left.cols, poles.left.rows, 64}, 0);
    StereoMatcher matcher(presetForest(preset), options);
    const cv::Mat found = matcher.match(poles.left, poles.right, {}).disparity.clone();
    options.search.levels = 0;
    matcher.setOptions(options);
    const cv::Mat full = matcher.match(poles.left, poles.right, {}).disparity;
    for (const int width : poleWidths()) {
      rows.push_back({{"far_px", far_px},
                      {"near_px", near_px},
                      {"width_px", width},
                      {"exhaustive", poleRecall(poles, width, full)},
                      {"preset", poleRecall(poles, width, found)}});
    }
  }
  std::printf("%s\n", rows.dump().c_str());
}

void runBenchmarks() {
  Context context;
  addMachine();
  addStages(context);
  addMethods(context);
#ifdef CBMV_BENCHMARK_CONTEXT
  benchmark::AddCustomContext("pair", pairSource());
  benchmark::AddCustomContext("simd", hwy::TargetName(realSimdTargets().front()));
#endif
  benchmark::RunSpecifiedBenchmarks();
}

}  // namespace
}  // namespace cbmv::benchmarks

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  CLI::App app{
      "Times the stages, the whole method and OpenCV's matchers. Takes the flags of Google "
      "Benchmark, such as --benchmark_filter. CBMV_DATA: folder that holds middlebury_eval3_H or "
      "middlebury_eval3_Q; without it, pairs are rendered"};
  std::string memory_preset;
  std::string poles_preset;
  std::string size = "1242x375x228";
  auto* memory = app.add_option("--peak-memory", memory_preset,
                                "Print the peak memory of this preset instead, in MiB, and that "
                                "before matching");
  app.add_option("--size", size, "Pair that it is measured on")->capture_default_str();
  app.add_option("--poles", poles_preset,
                 "Print which share of thin poles before a far background this preset finds "
                 "instead, as it is and by exhaustive search")
      ->excludes(memory);
  return cbmv::runTool(app, argc, argv, "cbmv_benchmark", [&] {
    if (!memory_preset.empty()) {
      cbmv::benchmarks::printPeakMemory(memory_preset, cbmv::benchmarks::findProblem(size));
    } else if (!poles_preset.empty()) {
      cbmv::benchmarks::printPoles(poles_preset);
    } else {
      cbmv::benchmarks::runBenchmarks();
    }
  });
}
