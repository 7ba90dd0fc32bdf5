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

/// Writes inspection views of a sampler at the first visible surfaces, as <sampler>/views/*.png; for sampler 0 also the
/// sampler-independent ones, as views/*.png. Takes some seconds. Records what was written. Returns false if cancelled.
bool WriteViews(const ExperimentContext &context, size_t sampler, const Integrator &integrator);
/// True if all recorded images of the sampler exist with their file sizes.
bool HasViews(const ExperimentContext &context, size_t sampler);
/// Adds "views" to results.json, for the scene and every sampler with views.
void AddViews(const ExperimentContext &context, Json *results);

/// Exposure factor before the PNG's sRGB curve, which clips at 1, from the reference's luminances. Maps the median of
/// the non-black pixels to mid grey, 0.18, so that interiors are visible, but keeps three quarters of these pixels
/// below 0.9. Never below the factor that maps the 98th percentile to 0.9. Shared by all images of an experiment.
double ChooseExposure(const Image &reference);
/// Writes R, G, B with full range as a Radiance file: shared exponent, 8 bits per colour, no run-length coding.
void WriteRangeImage(const std::string &path, const Image &image);

/// Writes references, results and errors as images, and adds them and the crops to `json`.
void WritePictures(const ExperimentContext &context, const References &references,
                   const std::vector<std::vector<Image>> &pictures, Json *json);

}  // namespace ext::lab
