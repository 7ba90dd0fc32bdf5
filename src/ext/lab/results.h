#pragma once
#include "ext/lab/measures.h"
#include "ext/lab/reference.h"
#include "ext/lab/run_record.h"
#include "ext/lab/selection_check.h"

namespace ext::lab {

struct SamplerResult {
    SamplerChoice choice;
    size_t reference = 0;
    std::vector<RunRecord> runs;  ///< excluding rounds without samples
    /// Set by Summarize.
    double samples = 0, prepareSeconds = 0;  ///< means over the runs
    double cpuPerSample = 0;                 ///< render CPU seconds; excluding the first sample if there are more
    std::array<Summary, MeasureCount> measures;
    bool firefliesDecide = false;
    std::optional<double> speedUp;  ///< over the other sampler with the least time for this sampler's error
    std::string speedUpAgainst;
    BiasReport bias;  ///< of both checks together
    std::optional<SelectionReport> selection;
    Json summary;  ///< as in results.json
};

struct ExperimentResults {
    std::vector<SamplerResult> samplers;
    std::vector<Contender> contenders;  ///< in the order of `samplers`
    Conclusion conclusion;
};

/// `pictures`: final images of the runs, by sampler and seed. `selections`: by sampler; empty if not checked.
ExperimentResults Summarize(const ExperimentSettings &settings, const References &references,
                            std::vector<std::vector<RunRecord>> runs, const std::vector<std::vector<Image>> &pictures,
                            const std::vector<std::optional<SelectionReport>> &selections);

/// Text for the terminal: table, references, bias verdicts and conclusion.
std::string TableText(const ExperimentResults &results, const References &references);
/// CSV with one line per sampler, and with one line per sampler, seed and round.
std::string SummaryCsv(const ExperimentResults &results);
std::string RoundsCsv(const ExperimentResults &results);
/// Adds "samplers" and "conclusion" to results.json.
void AddToJson(const ExperimentResults &results, Json *json);

/// Replaces single-precision numbers by their shortest form: 0.01, not 0.009999999776482582.
void ShortenFloats(Json *json);

}  // namespace ext::lab
