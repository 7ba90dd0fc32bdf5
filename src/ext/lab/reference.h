#pragma once
#include <algorithm>
#include <optional>

#include "ext/lab/conclusion.h"
#include "ext/lab/experiment_settings.h"
#include "ext/lab/run_record.h"
#include "pbrt/core/progress.h"

namespace ext::lab {

/// Shows progress and remaining time of an experiment, from its phases' estimates.
class ExperimentDisplay {
  public:
    /// `time`: its clock; must outlive this object.
    ExperimentDisplay(ProgressSink *sink, const Progress &time) : sink_(sink), time_(time) {}

    void SetPhase(const std::string &phase) { phase_ = phase; }
    /// Sets the estimated seconds of all later phases.
    void SetAfter(double seconds) { after_ = seconds; }
    /// `left`: estimated seconds of the current phase; negative: unknown.
    void Show(double left) {
        if (!sink_ || time_.SecondsSince(shown_) < 0.2) return;
        shown_ = time_.Now();
        const double elapsed = time_.SecondsSince(start_), all = left >= 0 ? left + after_ : -1;
        sink_->Show(phase_, left >= 0 ? elapsed / std::max(elapsed + all, 1e-9) : 0, elapsed, all);
    }
    void Finish() {
        if (sink_) sink_->PhaseDone("experiment", time_.SecondsSince(start_));
    }

  private:
    ProgressSink *sink_;
    const Progress &time_;
    std::string phase_;
    double after_ = 0;
    Progress::Clock::time_point start_ = time_.Now(), shown_ = start_;
};

/// What all parts of an experiment use.
struct ExperimentContext {
    const ExperimentSettings &settings;
    const LabScene &scene;
    const PluginRegistry &registry;
    const RecordFolder &records;
    Progress &cancel;
    ExperimentDisplay &display;
};

/// Candidate sampler for a reference, with variance and cost estimated from a few samples.
struct PilotEntry {
    SamplerChoice choice;
    /// Variance of one sample per pixel, relative to the squared local brightness (8x8 tiles of the other candidates).
    /// Maximum of two estimates: from the candidate's own two images, and from its difference to the others.
    double variance = 0;
    double secondsPerSample = 0;  ///< per pixel sample, for the whole image
};

/// Ranks the experiment's samplers (except oracles) and stock's bvh and uniform over single lights by variance per
/// sample. Stores the result in the records. Returns nothing if cancelled.
std::optional<std::vector<PilotEntry>> RunPilot(const ExperimentContext &context);

/// Cost of a sampler; the mean of all for one without entry.
double SecondsPerSample(const std::vector<PilotEntry> &entries, const SamplerChoice &choice);
/// Estimates the seconds of all runs of the experiment.
double EstimateRuns(const ExperimentSettings &settings, const std::vector<PilotEntry> &entries);

struct Reference {
    Image image;               ///< R, G, B over the film's pixels
    std::vector<Image> parts;  ///< images of equal weight with mean `image`; empty: unknown
    std::string sampler;       ///< label, or pbrt's name without parameters; empty: unknown
    bool hasLabel = true;
    int samples = 0;              ///< per pixel, all parts; 0: unknown
    double seconds = 0;           ///< of rendering
    std::optional<double> noise;  ///< expected relL2 of `image`
    std::string source;           ///< file name
};

/// Extent of a rendered reference: samples, or if these are 0, seconds.
struct ReferenceRule {
    int samples = 0;     ///< per pixel; 0: by time
    double seconds = 0;  ///< estimated from the pilot
    /// --reference-spp if given; else 10 times the time budget of a run, or 16 times its samples, at least 512. At
    /// most 2^30 samples.
    static ReferenceRule For(const ExperimentSettings &settings);
    std::string Text() const;
    double EstimateSeconds(double perSample) const { return samples > 0 ? samples * perSample : seconds; }
};

/// Entries in the order in which they are chosen for references: by the variance of an image of that extent. Those of
/// the replayed experiment come first.
std::vector<PilotEntry> RankMakers(const ExperimentSettings &settings, std::vector<PilotEntry> entries);

struct References {
    std::vector<Reference> all;
    std::vector<PilotEntry> pilot;  ///< empty: none was made
    std::vector<size_t> ofSampler;  ///< index into `all` per sampler of the experiment
    std::vector<Doubt> doubts;
    std::vector<std::string> remarks;  ///< additional notes
    bool areDoubtful = false;          ///< one lacks rarely sampled light: differences from it prove no bias
};

/// Returns a doubt if two references are inconsistent: either they contradict each other although both samplers are
/// unbiased (`areStocks`), because one lacks light that its sampler rarely samples; or they differ much more than their
/// noise explains. Sets `*proveNoBias` in the first case.
std::optional<Doubt> Disagreement(const Reference &a, const Reference &b, bool areStocks, bool *proveNoBias);

/// Reads the user's file, or renders a reference with the first of RankMakers. No sampler is evaluated on its own
/// samples: if that sampler is compared itself, a second reference by the next best evaluates it. If the two contradict
/// each other (bias check), two references by stock samplers replace them; these are doubtful if they contradict each
/// other too. Differences beyond their noise are a doubt. Finished parts survive interruption. Returns nothing if
/// cancelled. Throws UserError.
///
/// File of a rendered reference: <scene>.reference-<hash>.exr, with a hash of everything its pixels depend on. In the
/// cache folder, or in the output folder if that is missing or not writable; never in the scene's folder.
std::optional<References> MakeReferences(const ExperimentContext &context);

std::string UserCacheFolder();  ///< $XDG_CACHE_HOME/pbrt_octree, else ~/.cache/pbrt_octree; empty if neither is set

/// Reads R, G, B of the film's pixels from an image that may be larger; without parts and noise. Throws UserError if it
/// does not cover the film, or its header names another scene, path depth or kind of light.
Reference ReadReference(const std::string &path, const LabScene &scene);

}  // namespace ext::lab
