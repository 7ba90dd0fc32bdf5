// Measures whether resampling would reduce the error. Of M candidates (a light and a point on it), drawn with the
// probabilities of octree, one gets the shadow ray: it is chosen in proportion to its unoccluded contribution times the
// visibility that octree learned (resampled importance sampling, Talbot et al. 2005). Prints, for camera vertices taken
// as white diffuse surfaces, the variance relative to that of M = 1 and the nanoseconds of one estimate.
//
//     bench_ris scene.pbrt [candidates ...]      (2 4 8)
#include "bench_scene.h"
#include "pbrt/core/error.h"
#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

constexpr int kTrials = 48;

struct Candidate {
    LightId light;
    std::optional<LightLiSample> sample;
    double value = 0;  ///< unoccluded contribution over the candidate's density
};

struct Bench {
    const Scene &scene;
    const LightSampler &learned, &unlearned;
    SampledWavelengths lambda;
    Rng rng{11};
    double visibilitySeconds = 0;

    Candidate Draw(const ext::PrepassVertex &v, const LightQuery &q) {
        Candidate c;
        std::optional<SampledLight> s = learned.Sample(q, rng.Uniform());
        const Point2 u = rng.Uniform2();
        if (!s) return c;
        c.light = s->light;
        c.sample = scene.Lights()[s->light].SampleLi(v.at, u, lambda, true);
        if (!c.sample || !c.sample->L || !(c.sample->pdf > 0)) return c;
        Float cosine = q.ns == Normal3(0) ? 1 : Dot(c.sample->wi, q.ns);
        if (!q.transmits && cosine * Dot(q.wo, q.ns) <= 0) return c;
        c.value = double(c.sample->L.Average() * std::abs(cosine) / (c.sample->pdf * s->pmf));
        return c;
    }

    /// An estimate of direct light at the vertex by one shadow ray.
    double Estimate(const ext::PrepassVertex &v, const LightQuery &q, int candidates) {
        Candidate chosen;
        double sum = 0, chosenWeight = 0;
        for (int i = 0; i < candidates; ++i) {
            Candidate c = Draw(v, q);
            if (!(c.value > 0)) continue;
            double weight = c.value;
            if (candidates > 1) {
                // A sampler made for resampling would have the visibility from its choice, so the time to find it is
                // not counted.
                const double start = Now();
                weight *= double(learned.PMF(q, c.light) / unlearned.PMF(q, c.light));
                visibilitySeconds += Now() - start;
            }
            sum += weight;
            if (double(rng.Uniform()) * sum < weight) {
                chosen = c;
                chosenWeight = weight;
            }
        }
        if (!(chosenWeight > 0) || scene.Occluded(v.at, *chosen.sample)) return 0;
        return chosen.value / chosenWeight * sum / candidates;
    }
};

std::unique_ptr<Integrator> Make(BenchScene &scene, bool learn) {
    LightChoice choice;
    choice.lightSampler = "octree:bsdf=false";
    BuiltIntegrator made = MakeIntegrator(scene.built, choice);
    PrepareContext context = scene.Context();
    if (learn) made.integrator->Prepare(context);
    return std::move(made.integrator);
}

int Run(int argc, char **argv) {
    if (argc < 2) {
        std::fprintf(stderr, "bench_ris scene.pbrt [candidates ...]\n");
        return 1;
    }
    std::vector<int> numbers{1};
    for (int i = 2; i < argc; ++i) numbers.push_back(std::atoi(argv[i]));
    if (numbers.size() == 1) numbers = {1, 2, 4, 8};

    BenchScene file(argv[1]);
    const BuiltScene &built = file.built;
    std::unique_ptr<Integrator> learned = Make(file, true), unlearned = Make(file, false);
    Bench bench{*built.scene, *learned->Lights(), *unlearned->Lights(), SampledWavelengths::SampleVisible(0.5f)};
    const std::vector<ext::PrepassVertex> vertices = file.Vertices(4000);

    std::vector<std::vector<double>> first(numbers.size()), second(numbers.size());
    std::vector<double> seconds(numbers.size());
    for (size_t m = 0; m < numbers.size(); ++m) {
        first[m].resize(vertices.size());
        second[m].resize(vertices.size());
        bench.visibilitySeconds = 0;
        const double start = Now();
        for (size_t i = 0; i < vertices.size(); ++i) {
            const LightQuery query = ext::QueryAt(vertices[i]);
            for (int t = 0; t < kTrials; ++t) {
                const double e = bench.Estimate(vertices[i], query, numbers[m]);
                first[m][i] += e / kTrials;
                second[m][i] += e * e / kTrials;
            }
        }
        seconds[m] = Now() - start - bench.visibilitySeconds;
    }
    // The mean of all estimators together, because each is unbiased.
    std::vector<double> mean(vertices.size(), 0.0);
    double overall = 0;
    for (size_t i = 0; i < vertices.size(); ++i) {
        for (size_t m = 0; m < numbers.size(); ++m) mean[i] += first[m][i] / double(numbers.size());
        overall += mean[i] / double(vertices.size());
    }
    std::printf("%zu vertices, %zu lights\n", vertices.size(), built.scene->Lights().Size());
    double base = 0;
    for (size_t m = 0; m < numbers.size(); ++m) {
        double variance = 0, average = 0;
        for (size_t i = 0; i < vertices.size(); ++i) {
            const double v = second[m][i] - first[m][i] * first[m][i];
            variance += v * kTrials / (kTrials - 1) / (mean[i] * mean[i] + 0.01 * overall * overall);
            average += first[m][i] / double(vertices.size());
        }
        if (m == 0) base = variance;
        std::printf("M %2d  relative variance %.3f  against M = 1 %.3f  mean %.4g  ns %.0f\n", numbers[m],
                    variance / double(vertices.size()), variance / base, average,
                    seconds[m] / double(vertices.size() * kTrials) * 1e9);
    }
    return 0;
}

}  // namespace
}  // namespace pbrt

int main(int argc, char **argv) {
    return pbrt::ReportingErrors([&] { return pbrt::Run(argc, argv); });
}
