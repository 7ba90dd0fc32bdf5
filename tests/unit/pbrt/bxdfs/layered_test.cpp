#include "pbrt/bxdfs/layered.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/bxdfs/henyey_greenstein.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "sphere_histogram.h"

namespace pbrt::test {
namespace {

/// The parameters of a stack of layers, from which both the lobe and its reference are made.
template <class Base>
struct Stack {
    const char *name;
    DielectricBxdf top;
    Base bottom;
    Float thickness, albedo, g;
    int maxDepth;
    std::shared_ptr<const CoatTable> table{};

    CoatedBxdf<Base> Lobe(int nSamples = 1) const {
        CoatedBxdf<Base> lobe(top, bottom, thickness, SampledSpectrum(albedo), g, maxDepth, nSamples);
        if constexpr (std::is_same_v<Base, DiffuseBxdf>)
            if (table) lobe.UseTable(*table);
        return lobe;
    }
};

DielectricBxdf Coat(Float eta, Float ax, Float ay) { return {eta, TrowbridgeReitz(ax, ay)}; }
DiffuseBxdf Paint(Float r) { return DiffuseBxdf(SampledSpectrum(r)); }
ConductorBxdf Metal(Float alpha) {
    return {TrowbridgeReitz(alpha, alpha), SampledSpectrum(0.3f), SampledSpectrum(2.5f)};
}

template <class Check>
void ForEachStack(Check check) {
    Stack<DiffuseBxdf> smooth{"smooth on diffuse", Coat(1.5f, 0, 0), Paint(0.7f), 0.05f, 0, 0, 12};
    Stack<DiffuseBxdf> rough{"rough on diffuse", Coat(1.6f, 0.5f, 0.5f), Paint(0.7f), 0.05f, 0, 0, 12};
    check(smooth);
    check(rough);
    auto checkTable = [&](Stack<DiffuseBxdf> stack, const char *name, std::optional<Float> alpha) {
        stack.name = name;
        stack.table = CoatTable::Shared(stack.top.Eta(), 0.05f, alpha);
        check(stack);
    };
    checkTable(smooth, "smooth on diffuse, exact", Float(0));
    checkTable(rough, "rough on diffuse, table for this roughness", 0.5f);
    checkTable(rough, "rough on diffuse, table for all", {});
    check(Stack<DiffuseBxdf>{"anisotropic on diffuse", Coat(1.4f, 0.2f, 0.7f), Paint(0.5f), 0.05f, 0, 0, 5});
    check(Stack<DiffuseBxdf>{"rough, medium, diffuse", Coat(1.5f, 0.4f, 0.4f), Paint(0.6f), 0.6f, 0.8f, 0.4f, 16});
    check(Stack<ConductorBxdf>{"smooth on rough metal", Coat(1.5f, 0, 0), Metal(0.4f), 0.01f, 0, 0, 10});
    check(Stack<ConductorBxdf>{"rough on rough metal", Coat(1.8f, 0.4f, 0.4f), Metal(0.5f), 0.01f, 0, 0, 10});
    check(Stack<ConductorBxdf>{"rough on mirror", Coat(1.5f, 0.3f, 0.3f), Metal(0), 0.01f, 0, 0, 10});
    check(Stack<ConductorBxdf>{"smooth, medium, metal", Coat(1.5f, 0, 0), Metal(0.5f), 0.5f, 0.7f, -0.3f, 20});
    check(Stack<ConductorBxdf>{"smooth, medium, mirror", Coat(1.5f, 0, 0), Metal(0), 0.5f, 0.7f, -0.3f, 20});
}

/// The reference: an analog walk of one photon. The lobes' own samplers draw all events; there are no connections, no
/// MIS and no roulette. `events` counts what maxDepth counts. Sets the direction in which light leaves and returns its
/// weight (0: none).
template <class Base>
double AnalogWalk(const Stack<Base> &stack, Vector3 wo, Rng &rng, Vector3 *leaving) {
    auto s = SampleLobe(stack.top, wo, rng, kRadiance);
    if (!s) return 0;
    double weight = WeightOf(*s);
    double depth = double(stack.thickness);  // the position is 0 below the coat, and `thickness` at the base
    double position = 0;
    Vector3 w = s->wi;
    for (int events = 0; w.z < 0 || position > 0; ++events) {
        if (events == stack.maxDepth) return 0;
        double toBoundary = (w.z < 0 ? depth - position : position) / std::abs(double(w.z));
        if (stack.albedo > 0) {
            double free = -std::log(1 - double(rng.Uniform()));
            if (free < toBoundary) {
                position -= double(w.z) * free;
                weight *= double(stack.albedo);
                w = HenyeyGreenstein(stack.g).SampleP(-w, rng.Uniform2()).wi;
                continue;
            }
        } else {
            weight *= std::exp(-toBoundary);
        }
        bool atBase = w.z < 0;
        position = atBase ? depth : 0;
        auto bounce = atBase ? SampleLobe(stack.bottom, -w, rng, kRadiance) : SampleLobe(stack.top, -w, rng, kRadiance);
        if (!bounce) return 0;
        weight *= WeightOf(*bounce);
        w = bounce->wi;
    }
    *leaving = w;
    return weight;
}

/// The cells of the hemisphere: rings of equal projected solid angle, cut into sectors.
constexpr int kRings = 6, kSectors = 6;
int Cell(const Vector3 &w) {
    int ring = std::min(kRings - 1, int((1 - Sqr(w.z)) * kRings));
    double phi = std::atan2(double(w.y), double(w.x)) / (2 * M_PI);
    int sector = int((phi < 0 ? phi + 1 : phi) * kSectors);
    return ring * kSectors + std::min(sector, kSectors - 1);
}

/// Statistics per cell of the weight that walks of the reference send there.
template <class Base>
std::vector<RunningStatistics> TwinCells(const Stack<Base> &stack, const Vector3 &wo, int n) {
    std::vector<RunningStatistics> cells(kRings * kSectors);
    std::vector<double> sum(cells.size()), sum2(cells.size());
    Rng rng(11);
    for (int i = 0; i < n; ++i) {
        Vector3 w;
        double weight = AnalogWalk(stack, wo, rng, &w);
        if (weight == 0) continue;
        auto c = size_t(Cell(w));
        sum[c] += weight;
        sum2[c] += weight * weight;
    }
    for (size_t c = 0; c < cells.size(); ++c) {
        cells[c].n = size_t(n);
        cells[c].mean = sum[c] / n;
        cells[c].m2 = sum2[c] - sum[c] * sum[c] / n;
    }
    return cells;
}

double ZOfDifference(const RunningStatistics &a, const RunningStatistics &b, double floor) {
    double variance = a.StandardError() * a.StandardError() + b.StandardError() * b.StandardError() + floor * floor;
    return std::abs(a.mean - b.mean) / std::sqrt(variance);
}

/// Expects cells that walks of the reference have, except for `left`.
template <class Base>
void ExpectCells(const std::vector<RunningStatistics> &cells, const Stack<Base> &stack, const Vector3 &wo,
                 std::optional<size_t> left = {}) {
    constexpr double kMax = 4.8;  // 12 stacks x 2 views x 36 cells
    const std::vector<RunningStatistics> twin = TwinCells(stack, wo, 40000);
    for (size_t c = 0; c < cells.size(); ++c) {
        if (c == left) continue;
        EXPECT_LT(ZOfDifference(cells[c], twin[c], 1e-5), kMax)
            << stack.name << " theta " << SafeACos(wo.z) / Radians(1) << " cell " << c << ": " << cells[c].mean
            << " twin " << twin[c].mean;
    }
}

TEST(Layered, MeanOfConsistentFIsWhatAnalogWalksSend) {
    ForEachStack([&](const auto &stack) {
        auto lobe = stack.Lobe();
        for (Vector3 wo : {DirectionAt(35, 20), DirectionAt(70, 100)}) {
            std::vector<RunningStatistics> cells(kRings * kSectors);
            Rng rng(12);
            // The samples are uniform in projected solid angle within each cell, so the mean of f * (Pi / cells) is the
            // share of the cell.
            for (int i = 0; i < 40000; ++i) {
                auto c = size_t(i) % cells.size();
                Point2 u = rng.Uniform2();
                Float sin2 = (Float(c / kSectors) + u.x) / kRings;
                Float phi = 2 * Pi * (Float(c % kSectors) + u.y) / kSectors;
                Vector3 wi = SphericalDirection(std::sqrt(sin2), std::sqrt(1 - sin2), phi);
                cells[c].Add(double(lobe.FConsistent(wo, wi, kRadiance)[0]) * M_PI / double(cells.size()));
            }
            // Mirror images are delta functions, which F leaves out: for stacks that have them, only non-specular light
            // is compared.
            std::optional<size_t> mirrored;
            if (stack.top.IsSmooth()) mirrored = size_t(Cell(Vector3(-wo.x, -wo.y, wo.z)));
            ExpectCells(cells, stack, wo, mirrored);
        }
    });
}

TEST(Layered, SampleSendsWhatAnalogWalksSend) {
    ForEachStack([&](const auto &stack) {
        auto lobe = stack.Lobe();
        for (Vector3 wo : {DirectionAt(35, 20), DirectionAt(70, 100)}) {
            std::vector<RunningStatistics> cells(kRings * kSectors);
            Rng rng(13);
            for (int i = 0; i < 40000; ++i) {
                auto s = SampleLobe(lobe, wo, rng, kRadiance);
                size_t hit = s ? size_t(Cell(s->wi)) : cells.size();
                if (s) {
                    EXPECT_TRUE(s->pdfIsProportional);
                    EXPECT_TRUE(IsReflective(s->flags) && !IsTransmissive(s->flags));
                }
                for (size_t c = 0; c < cells.size(); ++c) cells[c].Add(c == hit ? WeightOf(*s) : 0);
            }
            ExpectCells(cells, stack, wo);
        }
    });
}

/// The reference for what the weights of stock pbrt-v4 add: a plain walk without roulette. For every direction drawn
/// inside it adds the light that leaves along wi, times (stock's weight - the consistent one).
template <class Base>
double ExcessWalk(const Stack<Base> &stack, const Vector3 &wo, const Vector3 &wi, Rng &rng) {
    auto in = SampleLobe(stack.top, wo, rng, kRadiance, ReflTransFlags::Transmission);
    if (!in) return 0;
    double weight = WeightOf(*in), excess = 0, height = double(stack.thickness);
    Vector3 w = in->wi;
    for (int events = 0; events < stack.maxDepth; ++events) {
        double pdf = 0, toBoundary = (w.z < 0 ? height : double(stack.thickness) - height) / std::abs(double(w.z));
        double free = stack.albedo > 0 ? -std::log(1 - double(rng.Uniform())) : 1e30;
        if (free < toBoundary) {
            height += double(w.z) * free;
            weight *= double(stack.albedo);
            HenyeyGreenstein phase(stack.g);
            Vector3 next = phase.SampleP(-w, rng.Uniform2()).wi;
            pdf = double(phase.P(-w, next));
            w = next;
        } else {
            if (stack.albedo == 0) weight *= std::exp(-toBoundary);
            bool atBase = w.z < 0;
            height = atBase ? 0 : double(stack.thickness);
            auto bounce = atBase ? SampleLobe(stack.bottom, -w, rng, kRadiance)
                                 : SampleLobe(stack.top, -w, rng, kRadiance, ReflTransFlags::Reflection);
            if (!bounce) break;
            weight *= WeightOf(*bounce);
            w = bounce->wi;
            if (!atBase) continue;
            pdf = double(bounce->pdf);
        }
        if (w.z < 0) continue;
        double forward = double(stack.top.Pdf(-w, wi, kRadiance, ReflTransFlags::Transmission));
        double backward = double(stack.top.Pdf(wi, -w, kRadiance, ReflTransFlags::Transmission));
        double difference = pdf * pdf / (pdf * pdf + forward * forward) - pdf * pdf / (pdf * pdf + backward * backward);
        double transmittance = std::exp(-(double(stack.thickness) - height) / double(w.z));
        double f = double(stack.top.F(-w, wi, kRadiance)[0]);
        if (f > 0) excess += weight * transmittance * difference * f;
    }
    return excess;
}

TEST(Layered, FExceedsTheConsistentValueByStocksWeights) {
    ForEachStack([&](const auto &stack) {
        auto lobe = stack.Lobe();
        Vector3 wo0 = DirectionAt(30, 0), wi0 = DirectionAt(50, 140);
        // There is only one technique to leave, so there are no weights.
        if (stack.top.IsSmooth() || IsSpecular(stack.bottom.Flags())) {
            EXPECT_EQ(lobe.F(wo0, wi0, kRadiance)[0], lobe.FConsistent(wo0, wi0, kRadiance)[0]) << stack.name;
            return;
        }
        RunningStatistics stock, consistent, excess;
        Rng rng(20);
        for (int i = 0; i < 40000; ++i) {
            Vector3 wo = DirectionAt(30 + rng.Uniform() * 0.01f, 0), wi = DirectionAt(50, 140 + rng.Uniform() * 0.01f);
            stock.Add(double(lobe.F(wo, wi, kRadiance)[0]) - double(lobe.FConsistent(wo, wi, kRadiance)[0]));
            consistent.Add(double(lobe.FConsistent(wo, wi, kRadiance)[0]));
            excess.Add(ExcessWalk(stack, wo0, wi0, rng));
        }
        EXPECT_GT(stock.mean, 0.02 * consistent.mean) << stack.name;
        EXPECT_LT(ZOfDifference(stock, excess, 1e-3 * excess.mean), 4.5)
            << stack.name << ' ' << stock.mean << ' ' << excess.mean;
    });
}

/// The mean over directions of F with each of the tables minus F by random walks, in standard errors; the greatest of
/// them. What quadrature and interpolation may be off, 1e-3 of the mean, counts as one more standard error.
double ZOfTables(const CoatedDiffuseBxdf &walks, const std::vector<CoatedDiffuseBxdf> &tables, Float grazing,
                 uint64_t seed) {
    EXPECT_FALSE(walks.UsesTable());
    for (const CoatedDiffuseBxdf &table : tables) EXPECT_TRUE(table.UsesTable());
    std::vector<RunningStatistics> difference(tables.size()), value(tables.size());
    Rng rng(seed);
    for (int i = 0; i < 60000; ++i) {
        Vector3 wo = SampleCosineHemisphere(rng.Uniform2()), wi = SampleCosineHemisphere(rng.Uniform2());
        wo.z *= grazing;
        wo = Normalize(wo);
        if (wo.z == 0 || wi.z == 0) continue;
        const double walk = double(walks.F(wo, wi, kRadiance)[0]);
        for (size_t k = 0; k < tables.size(); ++k) {
            const double f = double(tables[k].F(wo, wi, kRadiance)[0]);
            value[k].Add(f);
            difference[k].Add(f - walk);
        }
    }
    double z = 0;
    for (size_t k = 0; k < tables.size(); ++k)
        z = std::max(z, std::abs(difference[k].mean) / std::hypot(difference[k].StandardError(), 1e-3 * value[k].mean));
    return z;
}

TEST(Layered, TablesHoldTheMeanOfTheWalks) {
    const double zMax = 4.5;
    uint64_t seed = 100;
    for (Float eta : {1.33f, 1.5f, 2.f, 0.8f})
        for (Float thickness : {0.001f, 0.3f}) {
            const auto all = CoatTable::Shared(eta, thickness, {});
            for (Float alpha : {0.f, 0.004f, 0.06f, 0.25f, 0.5f, 0.95f}) {
                if (eta < 1 && alpha > 0) continue;
                for (int maxDepth : {1, 4, 11, 60}) {
                    const Stack<DiffuseBxdf> walks{"",      Coat(eta, alpha, alpha), Paint(0.75f), thickness, 0, 0,
                                                   maxDepth};
                    Stack<DiffuseBxdf> ofAll = walks, ofThis = walks;
                    ofAll.table = all;
                    ofThis.table = CoatTable::Shared(eta, thickness, alpha);
                    const Float grazing = maxDepth == 4 ? Float(0.2) : Float(1);
                    EXPECT_LT(ZOfTables(walks.Lobe(), {ofAll.Lobe(), ofThis.Lobe()}, grazing, ++seed), zMax)
                        << "eta " << eta << " thickness " << thickness << " alpha " << alpha << " events " << maxDepth;
                }
            }
        }
    // An error of 2 % of the base is noticed.
    Stack<DiffuseBxdf> walks{"", Coat(1.5f, 0.25f, 0.25f), Paint(0.75f), 0.01f, 0, 0, 10};
    Stack<DiffuseBxdf> wrong = walks;
    wrong.table = CoatTable::Shared(1.5f, 0.01f, 0.25f);
    wrong.bottom = Paint(0.75f * 0.98f);
    EXPECT_GT(ZOfTables(walks.Lobe(), {wrong.Lobe()}, 1, 7), zMax);
}

TEST(Layered, TablesAreUsedOnlyForTheirCoats) {
    const auto one = CoatTable::Shared(1.5f, 0.01f, 0.3f), all = CoatTable::Shared(1.5f, 0.01f, {});
    EXPECT_EQ(one, CoatTable::Shared(1.5f, 0.01f, 0.3f));
    auto uses = [](const CoatTable &table, Float ax, Float ay, Float albedo) {
        CoatedDiffuseBxdf lobe(Coat(1.5f, ax, ay), Paint(0.5f), 0.01f, SampledSpectrum(albedo), 0, 10, 1);
        lobe.UseTable(table);
        return lobe.UsesTable();
    };
    EXPECT_TRUE(uses(*one, 0.3f, 0.3f, 0));
    EXPECT_TRUE(uses(*one, 0, 0, 0));
    EXPECT_FALSE(uses(*one, 0.31f, 0.31f, 0));
    EXPECT_FALSE(uses(*one, 0.3f, 0.3f, 0.1f));
    EXPECT_TRUE(uses(*all, 0.31f, 0.31f, 0));
    EXPECT_TRUE(uses(*all, 1e-3f, 1e-3f, 0));
    EXPECT_FALSE(uses(*all, 0.31f, 0.3f, 0));
    EXPECT_FALSE(uses(*all, 1.01f, 1.01f, 0));
    CoatedDiffuseBxdf lobe(Coat(1.5f, 0, 0), Paint(0.5f), 0.01f, SampledSpectrum(0), 0, 10, 1);
    lobe.UseTable(*one);
    lobe.Regularize();
    EXPECT_FALSE(lobe.UsesTable());
}

TEST(Layered, DensityUnderASmoothCoatIsTheBasesForTheRefractedDirections) {
    Stack<ConductorBxdf> stack{"", Coat(1.5f, 0, 0), Metal(0.4f), 0.01f, 0, 0, 10};
    auto lobe = stack.Lobe();
    Vector3 wo = DirectionAt(35, 20), in, out;
    for (Vector3 wi : {DirectionAt(20, 190), DirectionAt(60, 50), DirectionAt(85, 230)}) {
        ASSERT_TRUE(Refract(wo, {0, 0, 1}, 1.5f, nullptr, &in) && Refract(wi, {0, 0, 1}, 1.5f, nullptr, &out));
        Float base = stack.bottom.Pdf(-in, -out, kRadiance);
        EXPECT_NEAR(lobe.Pdf(wo, wi, kRadiance), 0.9f * base + 0.1f * Inv4Pi, 1e-3f * (base + 0.01f));
        EXPECT_FLOAT_EQ(lobe.Pdf(wo, -wi, kRadiance), 0.1f * Inv4Pi);
    }
}

// The reference: the two weighted integrals over the direction inside, estimated by uniform directions.
TEST(Layered, MeanDensityUnderARoughCoatIsTheSumOfTheWeightedIntegrals) {
    ForEachStack([&](const auto &stack) {
        if (stack.top.IsSmooth() || IsSpecular(stack.bottom.Flags())) return;
        auto lobe = stack.Lobe();
        RunningStatistics density, twin;
        Rng rng(21);
        for (int i = 0; i < 40000; ++i) {
            Vector3 wo = DirectionAt(30 + rng.Uniform() * 0.01f, 0), wi = DirectionAt(50, 140 + rng.Uniform() * 0.01f);
            density.Add(double(lobe.Pdf(wo, wi, kRadiance)));
            auto in = SampleLobe(stack.top, wo, rng, kRadiance, ReflTransFlags::Transmission);
            Vector3 up = SampleUniformHemisphere(rng.Uniform2());
            double sum = double(stack.top.Pdf(wo, wi, kRadiance, ReflTransFlags::Reflection));
            if (in) {
                double base = double(stack.bottom.Pdf(-in->wi, up, kRadiance));
                double out = double(stack.top.Pdf(wi, -up, kRadiance, ReflTransFlags::Transmission));
                double through = double(stack.top.Pdf(-up, wi, kRadiance));
                // A metal may sample a direction into itself; then nothing inside is counted.
                bool counted = SampleLobe(stack.bottom, -in->wi, rng, kRadiance).has_value();
                if (out > 0 && counted) sum += 2 * M_PI * out * base * out * out / (out * out + base * base);
                if (base > 0) sum += 2 * M_PI * base * through * base * base / (base * base + through * through);
            }
            twin.Add(0.9 * sum + 0.1 / (4 * M_PI));
        }
        EXPECT_LT(ZOfDifference(density, twin, 2e-3 * twin.mean), 4.5)
            << stack.name << ' ' << density.mean << ' ' << twin.mean;
    });
}

/// The mean of f cos / pdf, with its standard error.
template <class Lobe>
RunningStatistics AlbedoStatistics(const Lobe &lobe, const Vector3 &wo, int n) {
    RunningStatistics albedo;
    Rng rng(16);
    for (int i = 0; i < n; ++i) {
        auto s = SampleLobe(lobe, wo, rng, kRadiance);
        albedo.Add(s ? WeightOf(*s) : 0);
    }
    return albedo;
}

/// Nothing absorbs in smooth coats on white bases, if the medium is too thin to matter or only scatters.
TEST(Layered, WhiteBaseUnderClearCoatReflectsEverything) {
    const Vector3 wo = DirectionAt(50, 20);
    const auto expectAll = [&](const auto &lobe, const std::string &name) {
        const RunningStatistics a = AlbedoStatistics(lobe, wo, 20000);
        EXPECT_LT(std::abs(a.mean - 1), 4 * a.StandardError() + 1e-3) << name;
    };
    CoatedDiffuseBxdf clear(Coat(1.5f, 0, 0), Paint(1), 1e-6f, SampledSpectrum(0), 0, 2000, 1);
    expectAll(clear, "clear");
    expectAll(CoatedDiffuseBxdf(Coat(1.5f, 0, 0), Paint(1), 0.5f, SampledSpectrum(1), 0.3f, 4000, 1), "milky");
    clear.UseTable(CoatTable::Compute(1.5f, 1e-6f, 0));
    expectAll(clear, "by a table");
    // The limit of a metal: a mirror that absorbs nothing.
    const ConductorBxdf mirror(TrowbridgeReitz(0, 0), SampledSpectrum(1), SampledSpectrum(1e6f));
    for (Float eta : {1.2f, 1.5f, 2.f})
        expectAll(CoatedConductorBxdf(Coat(eta, 0, 0), mirror, 1e-6f, SampledSpectrum(0), 0, 2000, 1),
                  fmt::format("mirror under {}", eta));
    // The model loses the light that bounces between facets, but never gains any.
    const RunningStatistics rough = AlbedoStatistics(
        CoatedDiffuseBxdf(Coat(1.5f, 0.1f, 0.1f), Paint(1), 1e-6f, SampledSpectrum(0), 0, 2000, 1), wo, 20000);
    EXPECT_LT(rough.mean, 1 + 4 * rough.StandardError());
    EXPECT_GT(rough.mean, 0.9);
}

TEST(Layered, MoreSamplesSameMeanLessNoise) {
    Stack<DiffuseBxdf> stack{"", Coat(1.5f, 0.4f, 0.4f), Paint(0.8f), 0.3f, 0.6f, 0.2f, 12};
    auto one = stack.Lobe(1), four = stack.Lobe(4);
    RunningStatistics f1, f4;
    Rng rng(17);
    for (int i = 0; i < 20000; ++i) {
        // The estimate depends on the last bits of the directions, but its mean hardly does.
        Vector3 wo = DirectionAt(30 + rng.Uniform() * 0.01f, 0), wi = DirectionAt(60, 140 + rng.Uniform() * 0.01f);
        f1.Add(double(one.F(wo, wi, kRadiance)[0]));
        f4.Add(double(four.F(wo, wi, kRadiance)[0]));
    }
    EXPECT_LT(ZOfDifference(f1, f4, 0), 4);
    EXPECT_LT(f4.Variance(), f1.Variance() / 3);
}

TEST(Layered, ReciprocalInTheMean) {
    ForEachStack([&](const auto &stack) {
        auto lobe = stack.Lobe();
        RunningStatistics there, back;
        Rng rng(18);
        for (int i = 0; i < 20000; ++i) {
            Vector3 wo = DirectionAt(30 + rng.Uniform() * 0.01f, 0), wi = DirectionAt(55, 140 + rng.Uniform() * 0.01f);
            there.Add(double(lobe.FConsistent(wo, wi, kRadiance)[0]));
            back.Add(double(lobe.FConsistent(wi, wo, kRadiance)[0]));
        }
        EXPECT_LT(ZOfDifference(there, back, 1e-4 * there.mean), 4.5) << stack.name;
    });
}

TEST(Layered, TwoSidedAndRepeatable) {
    ForEachStack([&](const auto &stack) {
        auto lobe = stack.Lobe();
        Vector3 wo = DirectionAt(30, 50), wi = DirectionAt(40, 200);
        EXPECT_EQ(lobe.F(wo, wi, kRadiance)[2], lobe.F(wo, wi, kRadiance)[2]);
        EXPECT_EQ(lobe.F(wo, wi, kRadiance)[2], lobe.F(-wo, -wi, kRadiance)[2]);
        EXPECT_EQ(lobe.Pdf(wo, wi, kRadiance), lobe.Pdf(-wo, -wi, kRadiance));
        EXPECT_FALSE(lobe.F(wo, -wi, kRadiance));
        Rng rng(19);
        int drawn = 0;
        for (int i = 0; i < 100; ++i) {
            Float uc = rng.Uniform();
            Point2 u = rng.Uniform2();
            auto front = lobe.Sample(wo, uc, u, kRadiance);
            auto behind = lobe.Sample(-wo, uc, u, kRadiance);
            ASSERT_EQ(front.has_value(), behind.has_value());
            if (!front) continue;
            ++drawn;
            EXPECT_EQ(front->wi, -behind->wi);
            EXPECT_EQ(front->pdf, behind->pdf);
        }
        EXPECT_GT(drawn, 20);
    });
}

}  // namespace
}  // namespace pbrt::test
