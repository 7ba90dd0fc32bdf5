#pragma once
#include "ext/lab/reference.h"

namespace ext::lab {

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

/// $XDG_CACHE_HOME/pbrt_octree, else ~/.cache/pbrt_octree; empty if neither is known.
std::string UserCacheFolder();

/// Reads R, G, B of the film's pixels from a picture that may be larger; without parts and noise. Throws UserError if
/// it does not cover the film.
Reference ReadReference(const std::string &path, const LabScene &scene);
/// Sets `image` to the mean of the parts and, if there are several, `noise`.
void AverageParts(Reference *reference);

}  // namespace ext::lab
