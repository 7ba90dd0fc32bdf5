#pragma once
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pbrt/lights/light_table.h"
#include "pbrt/lightsamplers/light_sampler.h"

/// The contract of light samplers as checks of any sampler at any places. Each check reports through GoogleTest and
/// must be called inside a test.
namespace pbrt::test {

/// A sampler that is ready for use, the places of queries, and its PMF at every place for every light; and what it
/// chooses there for stratified numbers: one in each of many equal parts of [0, 1).
struct SamplerSubject {
    std::unique_ptr<LightSampler> sampler;
    std::span<const LightQuery> queries;
    const LightTable *table = nullptr;
    std::vector<LightId> ids;
    std::vector<std::vector<Float>> pmf;   ///< by query, by index of `ids`
    std::vector<double> sum;               ///< by query
    int strata = 0;                        ///< stratified numbers per query
    std::vector<std::vector<int>> chosen;  ///< how many of them choose a light, by query, by index of `ids`

    SamplerSubject() = default;
    SamplerSubject(std::unique_ptr<LightSampler> made, std::span<const LightQuery> places, const LightTable &lights);
    size_t IndexOf(LightId id) const { return id.value; }
    /// The number of calls per query, at most `most`: fewer where there are many lights, so that a sampler that weighs
    /// every light at each call takes bearable time.
    int Calls(int most) const;
};

/// Contributions of all lights, by query and index of the subject's ids.
using Contributions = std::vector<std::vector<double>>;
Contributions ContributionsOf(const SamplerSubject &subject,
                              const std::function<double(size_t query, LightId)> &contribution);

/// The pmf of a sample without region equals the sampler's PMF of that light to the last bit, also for the least and
/// the greatest uniform number; with a region it is not greater.
void CheckPmfOfSamples(const SamplerSubject &subject);
/// No probability is negative or above 1; they add up to 1, or Sample returns nothing with the probability that is
/// missing.
void CheckPmfSums(const SamplerSubject &subject);
/// Lights are chosen as often as by the PMF, and what is left of the number for the point is uniform: chi-square
/// tests per query, corrected for the number of queries. Neighbouring lights of large sets share a cell.
void CheckFrequencies(const SamplerSubject &subject);
/// Every light that contributes to a query has a positive PMF there. Returns the number of such pairs of query and
/// light.
size_t CheckContributingCanBeChosen(const SamplerSubject &subject, const Contributions &contributions);
/// The mean of contribution / pmf over stratified numbers is the sum over all lights.
void CheckOneLightEstimator(const SamplerSubject &subject, const Contributions &contributions);
/// A direction drawn from a sampled region leads back to the region, with the same pmf to the last bit and the same
/// density. Returns the number of samples with a region.
size_t CheckRegions(const SamplerSubject &subject);
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
