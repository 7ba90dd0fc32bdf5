#pragma once
#include "pbrt/lab/reference.h"

namespace pbrt::lab {

/// Where a rendered reference is kept, by everything that decides its pixels: <scene>.reference-<hash>.exr in the cache
/// folder, or in the output folder if there is none or it cannot be written. Never in the scene's folder.
class ReferenceCache {
  public:
    /// `what`: sampler, rule, seeds.
    ReferenceCache(const CampaignSettings &settings, const LabScene &scene, const std::string &what);
    /// A file that cannot be read, or lacks parts, is a warning and as good as absent.
    std::optional<Reference> Find() const;
    /// Sets reference.source. A cache folder that cannot be written is a warning.
    void Store(const LabScene &scene, const std::string &about, Reference *reference) const;
    const std::string &Key() const { return key_; }

  private:
    Point2i resolution_;
    std::string key_;
    std::vector<std::string> files_;  ///< in the order in which they are looked for and written
};

/// $XDG_CACHE_HOME/pbrt_octree, else ~/.cache/pbrt_octree; empty if neither is known.
std::string UserCacheFolder();

/// R, G, B of the film's pixels of a picture that may be larger. With the parts, if the file has them.
Reference ReadReference(const std::string &path, const LabScene &scene);
/// The mean of the parts, and its noise.
void AverageParts(Reference *reference);

}  // namespace pbrt::lab
