#pragma once
#include <optional>

#include "ext/lab/conclusion.h"
#include "ext/lab/pilot.h"

namespace ext::lab {

/// What the runs are compared with.
struct Reference {
    Image image;                  ///< R, G, B over the film's pixels
    std::vector<Image> parts;     ///< pictures of equal weight whose mean `image` is; empty: not known
    std::string sampler;          ///< label; empty: given by the user
    int samples = 0;              ///< per pixel, all parts; 0: not known
    double seconds = 0;           ///< to render it
    std::optional<double> noise;  ///< expected relL2 of `image` against the truth
    std::string source;           ///< the file that holds it
};

/// How many samples a rendered reference gets.
struct ReferenceRule {
    int samples = 0;     ///< per pixel; 0: by time
    double seconds = 0;  ///< estimated from the pilot
    /// --reference-spp, if given; else 10 times the time of a run that is limited by time, or 16 times the samples of a
    /// run, at least 512.
    static ReferenceRule For(const ExperimentSettings &settings);
    std::string Text() const;
    double EstimateSeconds(double perSample) const { return samples > 0 ? samples * perSample : seconds; }
};

struct References {
    std::vector<Reference> all;
    std::vector<size_t> ofSampler;  ///< index into `all`, for every sampler of the experiment
    std::vector<Doubt> doubts;
    std::vector<std::string> remarks;  ///< further notes on the references
    bool areDoubtful = false;          ///< one lacks light that is rarely met: a difference from it proves no bias
};

/// Returns a doubt if two references cannot both be right: either they contradict each other
/// although both were made by unbiased samplers (`areStocks`), because one lacks light that its sampler meets rarely;
/// or they differ much more than their noise explains. Sets `*proveNoBias` in the first case.
std::optional<Doubt> Disagreement(const Reference &a, const Reference &b, bool areStocks, bool *proveNoBias);

/// Reads the user's file, or else renders a reference with the best sampler of a pilot run. If that sampler is compared
/// itself, a second reference, rendered with the next best, judges it, so that no sampler is judged by its own samples.
/// If the two contradict each other (bias check), two references made by samplers of stock pbrt replace them; these are
/// doubtful if they contradict each other too. Two that differ more than their noise explains are a doubt. Rendered
/// references are kept in the cache folder (reference_cache.h) and found there again. Finished parts survive an
/// interruption. Returns nothing if cancelled. Throws UserError.
std::optional<References> MakeReferences(const ExperimentSettings &settings, const LabScene &scene,
                                         const PluginRegistry &registry, const RecordFolder &records, Progress &cancel,
                                         ExperimentDisplay &display);

/// The file of a rendered reference: <scene>.reference-<hash>.exr, with a hash of everything that its pixels depend on.
/// It is in the cache folder, or in the output folder if there is no cache folder or it cannot be written; never in the
/// scene's folder.
class ReferenceCache {
  public:
    /// `what`: sampler, rule and seeds as text, a part of the hash.
    ReferenceCache(const ExperimentSettings &settings, const LabScene &scene, const std::string &what);
    /// A file that cannot be read, or lacks parts, gives a warning and counts as absent.
    std::optional<Reference> Find() const;
    /// Sets reference.source. A cache folder that cannot be written gives a warning; an output folder that cannot be
    /// written, an error.
    void Store(const LabScene &scene, const std::string &about, Reference *reference) const;
    const std::string &Key() const { return key_; }

  private:
    Point2i resolution_;
    std::string key_;
    std::vector<std::string> files_;  ///< in the order in which they are looked for and written
};

/// Returns $XDG_CACHE_HOME/pbrt_octree, else ~/.cache/pbrt_octree; empty if neither is known.
std::string UserCacheFolder();

/// Reads R, G, B of the film's pixels from a picture that may be larger; without parts and noise. Throws UserError if
/// it does not cover the film.
Reference ReadReference(const std::string &path, const LabScene &scene);
/// Sets `image` to the mean of the parts and, if there are several, `noise`.
void AverageParts(Reference *reference);

}  // namespace ext::lab
