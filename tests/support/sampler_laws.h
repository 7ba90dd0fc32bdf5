#pragma once
#include <memory>
#include <span>
#include <vector>

#include "pbrt/lightsamplers/light_sampler.h"

/// The contract of house.md section 4 as checks, for any sampler from any places. Each reports through GoogleTest; call
/// inside a test.
namespace pbrt::test {

/// What each light contributes: by query, by light.
using Contributions = std::vector<std::vector<double>>;

/// A sampler ready for use, places, and its PMF from every place to every light.
struct SamplerSubject {
    std::unique_ptr<LightSampler> sampler;
    std::span<const LightQuery> queries;
    size_t lights = 0;
    std::vector<std::vector<Float>> pmf;  ///< by query, by light
    std::vector<double> sum;              ///< by query

    SamplerSubject() = default;
    SamplerSubject(std::unique_ptr<LightSampler> made, std::span<const LightQuery> places, size_t lightCount);
    /// At most `most`: as many calls per query as a sampler that looks at every light for each can take.
    int Calls(int most) const;
};

/// The pmf that comes with a sample is the sampler's PMF of that light, to the last bit; also for the least and the
/// greatest number.
void CheckPmfOfSamples(const SamplerSubject &subject);
/// No probability is negative or above 1; they add up to 1, or nothing is returned as often as is missing.
void CheckPmfSums(const SamplerSubject &subject);
/// Chi-square per query, corrected for their number. Neighbouring lights of large sets share a cell.
void CheckFrequencies(const SamplerSubject &subject);
/// Returns how many pairs of query and light contribute.
size_t CheckContributingCanBeChosen(const SamplerSubject &subject, const Contributions &contributions);
/// The mean of contribution / pmf over samples is the sum over all lights.
void CheckOneLightEstimator(const SamplerSubject &subject, const Contributions &contributions);
/// The same answers from several threads at once as from one.
void CheckSameFromAnyThread(const SamplerSubject &subject);
/// The distributions of two vertices, each in its memory, answer as if the other one were not there.
void CheckDistributionsKeepApart(const SamplerSubject &subject);
/// Walking the number through the unit interval meets every likely light: there is no other source of randomness.
void CheckOneNumberReachesEveryLight(const SamplerSubject &subject);
/// Two samplers that should not differ in anything.
void CheckSame(const LightSampler &a, const LightSampler &b, std::span<const LightQuery> queries, size_t lights);

}  // namespace pbrt::test
