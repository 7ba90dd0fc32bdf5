#pragma once
#include "pbrt/lab/reference.h"
#include "pbrt/lab/run_record.h"
#include "pbrt/lab/selection_check.h"
#include "pbrt/lab/summary.h"

namespace pbrt::lab {

/// What is said of one sampler at the end.
struct SamplerResult {
    SamplerChoice choice;
    size_t reference = 0;
    std::vector<RunRecord> runs;  ///< without rounds that brought no sample
    /// Set by Summarize.
    double samples = 0, seconds = 0, cpuSeconds = 0;  ///< means over the runs
    double prepareSeconds = 0, prepareCpuSeconds = 0;
    std::array<Summary, MeasureCount> measures;
    bool firefliesDecide = false;
    double efficiency = 0;
    std::optional<double> speedUp;  ///< against the other that needs least time for this sampler's error
    std::string speedUpAgainst;
    std::vector<std::pair<std::string, double>> speedUps;  ///< against every other one
    std::optional<double> ratioToOracle;
    double cpuPerSample = 0;                  ///< of rendering, without the first sample where there are more
    double relativeCost = 0;                  ///< cpuPerSample over that of the first sampler
    double shadowRays = 0, blockedShare = 0;  ///< per run
    BiasReport bias;                          ///< both checks together
    std::optional<SelectionReport> selection;
};

struct CampaignResults {
    std::vector<SamplerResult> samplers;
    std::vector<Contender> contenders;  ///< in the order of `samplers`
    Conclusion conclusion;
};

/// `pictures`: last pictures of the runs, per sampler and seed. `selections`: per sampler, where the check was made.
CampaignResults Summarize(const CampaignSettings &settings, const References &references,
                          std::vector<std::vector<RunRecord>> runs, const std::vector<std::vector<Image>> &pictures,
                          const std::vector<std::optional<SelectionReport>> &selections);

/// The table for people, the verdicts, and the conclusion.
std::string TableText(const CampaignResults &results, const References &references);
/// One line per sampler; one line per sampler, seed and round.
std::string SummaryCsv(const CampaignResults &results);
std::string RoundsCsv(const CampaignResults &results);
/// "samplers" and "conclusion" of results.json.
void AddToJson(const CampaignResults &results, nlohmann::ordered_json *json);

/// Numbers that were single precision in their shortest form: 0.01, not 0.009999999776482582.
void ShortenFloats(nlohmann::ordered_json *json);

/// A number of LightSampler::Report by any of several names.
std::optional<double> ReportNumber(const nlohmann::ordered_json &report, std::initializer_list<const char *> names);

}  // namespace pbrt::lab
