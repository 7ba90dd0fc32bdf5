#pragma once
#include <optional>

#include "ext/lab/conclusion.h"
#include "ext/lab/pilot.h"

namespace ext::lab {

struct Reference {
    Image image;                  ///< R, G, B over the film's pixels
    std::vector<Image> parts;     ///< images of equal weight with mean `image`; empty: unknown
    std::string sampler;          ///< label; empty: provided by the user
    int samples = 0;              ///< per pixel, all parts; 0: unknown
    double seconds = 0;           ///< of rendering
    std::optional<double> noise;  ///< expected relL2 of `image`
    std::string source;           ///< file name
};

struct ReferenceRule {
    int samples = 0;     ///< per pixel; 0: by time
    double seconds = 0;  ///< estimated from the pilot
    /// --reference-spp if given; else 10 times the time of a time-limited run, or 16 times the samples of a run, at
    /// least 512.
    static ReferenceRule For(const ExperimentSettings &settings);
    std::string Text() const;
    double EstimateSeconds(double perSample) const { return samples > 0 ? samples * perSample : seconds; }
};

struct References {
    std::vector<Reference> all;
    std::vector<size_t> ofSampler;  ///< index into `all` per sampler of the experiment
    std::vector<Doubt> doubts;
    std::vector<std::string> remarks;  ///< additional notes
    bool areDoubtful = false;          ///< one lacks rarely sampled light: differences from it prove no bias
};

/// Returns a doubt if two references are inconsistent: either they contradict each other although both samplers are
/// unbiased (`areStocks`), because one lacks light that its sampler rarely samples; or they differ much more than their
/// noise explains. Sets `*proveNoBias` in the first case.
std::optional<Doubt> Disagreement(const Reference &a, const Reference &b, bool areStocks, bool *proveNoBias);

/// Reads the user's file, or renders a reference with the best sampler of a pilot run. No sampler is evaluated on its
/// own samples: if that sampler is compared itself, a second reference by the next best evaluates it. If the two
/// contradict each other (bias check), two references by stock samplers replace them; these are doubtful if they
/// contradict each other too. Differences beyond their noise are a doubt. Rendered references are stored in the cache
/// folder (reference_cache.h). Finished parts survive interruption. Returns nothing if cancelled. Throws UserError.
std::optional<References> MakeReferences(const ExperimentSettings &settings, const LabScene &scene,
                                         const PluginRegistry &registry, const RecordFolder &records, Progress &cancel,
                                         ExperimentDisplay &display);

/// File of a rendered reference: <scene>.reference-<hash>.exr, with a hash of everything its pixels depend on. In the
/// cache folder, or in the output folder if that is missing or not writable; never in the scene's folder.
class ReferenceCache {
  public:
    /// `what`: sampler, rule and seeds as text, part of the hash.
    ReferenceCache(const ExperimentSettings &settings, const LabScene &scene, const std::string &what);
    /// Files that are unreadable or lack parts give a warning and count as absent.
    std::optional<Reference> Find() const;
    /// Sets reference.source. A cache folder that is not writable gives a warning, an output folder an error.
    void Store(const LabScene &scene, const std::string &about, Reference *reference) const;
    const std::string &Key() const { return key_; }

  private:
    Point2i resolution_;
    std::string key_;
    std::vector<std::string> files_;  ///< in search and write order
};

/// $XDG_CACHE_HOME/pbrt_octree, else ~/.cache/pbrt_octree; empty if neither is set.
std::string UserCacheFolder();

/// Reads R, G, B of the film's pixels from an image that may be larger; without parts and noise. Throws UserError if it
/// does not cover the film.
Reference ReadReference(const std::string &path, const LabScene &scene);
/// Sets `image` to the mean of the parts and, if there are several, `noise`.
void AverageParts(Reference *reference);

}  // namespace ext::lab
