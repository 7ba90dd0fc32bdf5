#pragma once
#include <functional>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

/// The contract of light samplers as checks of any sampler at any places. Each check reports through GoogleTest and
/// must be called inside a test.
namespace pbrt::test {

/// A sampler that is ready for use, the places it is asked from, and its PMF at every place for every id: those of all
/// lights, and of all parts of skies that the sampler may choose.
struct SamplerSubject {
    std::unique_ptr<LightSampler> sampler;
    std::span<const LightQuery> queries;
    const LightTable *table = nullptr;
    std::vector<LightId> ids;
    std::vector<std::vector<Float>> pmf;  ///< by query, by index of `ids`
    std::vector<double> sum;              ///< by query

    SamplerSubject() = default;
    SamplerSubject(std::unique_ptr<LightSampler> made, std::span<const LightQuery> places, const LightTable &lights);
    size_t IndexOf(LightId id) const { return index.at(id.value); }
    /// The number of calls per query, at most `most`: fewer where there are many lights, so that a sampler that weighs
    /// every light at each call takes bearable time.
    int Calls(int most) const;
    /// False for a sky that is chosen by parts at a place, and for parts that are not seen from there: what they
    /// contribute is found through other ids.
    bool IsAsked(const LightDistribution &at, LightId id) const;
    bool IsSeenThroughWindows(const LightDistribution &at, LightId id) const;

  private:
    std::unordered_map<uint32_t, size_t> index;
};

/// What each id contributes, by query and index of the subject's ids: `contribution` of ids that are asked, else 0.
using Contributions = std::vector<std::vector<double>>;
Contributions ContributionsOf(const SamplerSubject &subject,
                              const std::function<double(size_t query, LightId)> &contribution);

/// The pmf that comes with a sample equals the sampler's PMF of that light to the last bit, also for the least and the
/// greatest uniform number.
void CheckPmfOfSamples(const SamplerSubject &subject);
/// No probability is negative or above 1; they add up to 1, or Sample returns nothing with the probability that is
/// missing.
void CheckPmfSums(const SamplerSubject &subject);
/// Lights are chosen as often as the PMF says, and what is left of the number for the point is uniform: chi-square
/// tests per query, corrected for the number of queries. Neighbouring lights of large sets share a cell.
void CheckFrequencies(const SamplerSubject &subject);
/// Every light that contributes to a query has a positive PMF there. Returns the number of such pairs of query and
/// light.
size_t CheckContributingCanBeChosen(const SamplerSubject &subject, const Contributions &contributions);
/// The mean of contribution / pmf over samples is the sum over all lights.
void CheckOneLightEstimator(const SamplerSubject &subject, const Contributions &contributions);
/// Directions and parts of skies belong together: a direction drawn from a chosen part leads back to it, whose density
/// there is the one that came with the sample.
void CheckSkyParts(const SamplerSubject &subject);
/// Several threads at once get the same answers as one thread.
void CheckSameFromAnyThread(const SamplerSubject &subject);
/// The distributions of two vertices, each in its own memory, do not influence each other.
void CheckDistributionsKeepApart(const SamplerSubject &subject);
/// Uniform numbers spread over the unit interval reach every likely light: there is no other source of randomness.
void CheckOneNumberReachesEveryLight(const SamplerSubject &subject);
/// The two samplers give equal answers to all queries.
void CheckSame(const LightSampler &a, const LightSampler &b, std::span<const LightQuery> queries,
               const LightTable &table);

}  // namespace pbrt::test
