#pragma once
#include "pbrt/samplers/sampler.h"
#include "support/given_params.h"

namespace pbrt::test {

constexpr const char *kRandomizations[] = {"none", "permutedigits", "owen", "fastowen"};  ///< of the Sobol samplers

/// A sampler with one of its randomizations ("": the default).
struct SamplerCase {
    std::string type, randomization;
    bool pixelOwnsDimensions = true;  ///< dimensions are counted from 0, and GetPixel2D uses two of them

    std::unique_ptr<Sampler> Make(int samples, int seed = 0, Point2i resolution = {64, 48}) const {
        Params params;
        if (!randomization.empty()) params.String("randomization", randomization);
        DiagnosticSink sink;
        return Samplers().Make(type, params, SamplerContext{resolution, samples, seed, sink});
    }
    std::string Name() const { return type + (randomization.empty() ? "" : "_" + randomization); }
};

/// All randomized samplers; the randomization "none" is left out.
inline std::vector<SamplerCase> RandomizedSamplers() {
    std::vector<SamplerCase> cases = {{"independent", "", true}, {"stratified", "", true}, {"pmj02bn", "", false}};
    for (const char *r : {"permutedigits", "owen"}) cases.push_back({"halton", r, false});
    for (const char *r : {"permutedigits", "owen", "fastowen"}) {
        cases.push_back({"sobol", r, false});
        cases.push_back({"paddedsobol", r, true});
        cases.push_back({"zsobol", r, true});
    }
    return cases;
}

}  // namespace pbrt::test
