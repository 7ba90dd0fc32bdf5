#pragma once
#include <optional>

#include "pbrt/lab/conclusion.h"
#include "pbrt/lab/pilot.h"

namespace pbrt::lab {

/// What the runs are compared with.
struct Reference {
    Image image;                  ///< R, G, B over the film's pixels
    std::vector<Image> parts;     ///< pictures of equal weight whose mean it is; empty: not known
    std::string sampler;          ///< label; empty: given by the user
    int samples = 0;              ///< per pixel, all parts; 0: not known
    double seconds = 0;           ///< to render it
    std::optional<double> noise;  ///< expected relL2 of `image` against the truth
    std::string source;           ///< the file it lies in
};

/// How many samples a rendered reference gets.
struct ReferenceRule {
    int samples = 0;     ///< per pixel; 0: by time
    double seconds = 0;  ///< estimated from the pilot
    /// --reference-spp; else 16 times the samples of a run, at least 512; else 10 times the time of a run.
    static ReferenceRule For(const CampaignSettings &settings);
    std::string Text() const;
    double EstimateSeconds(double perSample) const { return samples > 0 ? samples * perSample : seconds; }
};

struct References {
    std::vector<Reference> all;
    std::vector<size_t> ofSampler;  ///< index into `all`, for every sampler of the campaign
    std::vector<Doubt> doubts;
    std::vector<std::string> remarks;  ///< what else people should know about them
    bool areDoubtful = false;          ///< they lack light that is met rarely: no proof of a bias
};

/// Why two references cannot both be right, if that is so: both were made by samplers that are known to be free of bias
/// (`areStocks`) and contradict each other, or they differ much more than their noise explains, because one lacks light
/// that its sampler meets rarely. Sets `*proveNoBias` in the first case.
std::optional<Doubt> Disagreement(const Reference &a, const Reference &b, bool areStocks, bool *proveNoBias);

/// The user's file; or, ranked by a pilot run, pictures rendered with the best sampler and, if that one is in the
/// campaign, with the second best, which then judges it: no sampler is judged by its own samples. Two references that
/// contradict each other (bias check) are replaced by two of stock's samplers, which are doubtful if they do so too;
/// two that differ more than their noise explains are a doubt. Rendered ones are kept in the cache folder
/// (reference_cache.h) and found there again. Finished parts survive an interruption. Nothing: cancelled. Throws
/// UserError.
std::optional<References> MakeReferences(const CampaignSettings &settings, const LabScene &scene,
                                         const LightSamplerRegistry &registry, const RecordFolder &records,
                                         Progress &cancel, CampaignDisplay &display);

}  // namespace pbrt::lab
