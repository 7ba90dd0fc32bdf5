#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/samplers/sampler.h"
#include "support/param.h"

namespace pbrt::test {

inline ParamSet Params(const std::string &type, const std::vector<Param> &params) {
    ParamSet set("Sampler \"" + type + "\"", {});
    for (const Param &p : params) set.Add(p);
    return set;
}

/// A sampler with one of its randomizations ("": the default).
struct SamplerCase {
    std::string type, randomization;
    bool pixelOwnsDimensions = true;  ///< dimensions are counted from 0, and GetPixel2D uses two of them

    std::unique_ptr<Sampler> Make(int samples, int seed = 0, Point2i resolution = {64, 48}) const {
        std::vector<Param> params;
        if (!randomization.empty()) params.push_back(StringParam("randomization", randomization));
        DiagnosticSink sink;
        return Samplers().Make(type, Params(type, params), SamplerContext{resolution, samples, seed, sink});
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
