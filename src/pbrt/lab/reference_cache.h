#pragma once
#include "pbrt/lab/reference.h"

namespace pbrt::lab {

/// Where a rendered reference is kept, by everything that decides its pixels.
class ReferenceCache {
  public:
    /// `what`: sampler, rule, seeds.
    ReferenceCache(const CampaignSettings &settings, const LabScene &scene, const std::string &what);
    std::optional<Reference> Find() const;
    /// Beside the scene, else in the output folder. Sets reference.source.
    void Store(const LabScene &scene, const std::string &about, Reference *reference) const;
    const std::string &Key() const { return key_; }

  private:
    std::string key_, besideScene_, inOutput_;
};

/// R, G, B of the film's pixels of a picture that may be larger. With the parts, if the file has them.
Reference ReadReference(const std::string &path, const LabScene &scene);
/// The mean of the parts, and its noise.
void AverageParts(Reference *reference);

}  // namespace pbrt::lab
