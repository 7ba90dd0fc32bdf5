#include "pbrt/materials/material_params.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "../bxdfs/sphere_histogram.h"
#include "material_test_support.h"
#include "pbrt/bxdfs/fresnel.h"
#include "pbrt/math/frame.h"
#include "support/folder_test.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// Writes a tensor file in the format of the measured BRDF database, byte by byte.
class TensorWriter {
  public:
    void Add(const std::string &name, std::vector<uint64_t> shape, std::vector<float> values) {
        fields_.push_back({name, std::move(shape), std::move(values)});
    }
    std::string Bytes() const {
        size_t head = 18;
        for (const Field &f : fields_) head += 2 + f.name.size() + 2 + 1 + 8 + 8 * f.shape.size();
        std::string out("tensor_file\0", 12), body;
        out += std::string("\1\0", 2);
        Put<uint32_t>(out, uint32_t(fields_.size()));
        for (const Field &f : fields_) {
            Put<uint16_t>(out, uint16_t(f.name.size()));
            out += f.name;
            Put<uint16_t>(out, uint16_t(f.shape.size()));
            Put<uint8_t>(out, 10);
            Put<uint64_t>(out, head + body.size());
            for (uint64_t n : f.shape) Put<uint64_t>(out, n);
            body.append(reinterpret_cast<const char *>(f.values.data()), f.values.size() * sizeof(float));
        }
        return out + body;
    }

  private:
    struct Field {
        std::string name;
        std::vector<uint64_t> shape;
        std::vector<float> values;
    };
    template <class T>
    static void Put(std::string &out, T v) {
        out.append(reinterpret_cast<const char *>(&v), sizeof(T));
    }
    std::vector<Field> fields_;
};

constexpr Float kAlpha = 0.5f;
const std::vector<float> kWavelengths = {360, 500, 830};
/// Reflectance of the analytic surface, linear between the wavelengths of the table.
Float Tint(Float lambda) {
    return lambda < 500 ? Lerp((lambda - 360) / 140, .2f, .8f) : Lerp((lambda - 500) / 330, .8f, .5f);
}

Float NormalDistribution(Float cosTheta) { return Sqr(kAlpha) / (Pi * Sqr(Sqr(cosTheta) * (Sqr(kAlpha) - 1) + 1)); }
/// Projected area of the facets seen from theta (all that face the view, shadowed or not).
Float ProjectedArea(Float cosTheta) {
    return (cosTheta + std::sqrt(Sqr(cosTheta) + Sqr(kAlpha) * (1 - Sqr(cosTheta)))) / 2;
}
/// The BRDF of the analytic surface. Any function that is not too simple would do.
Float Analytic(const Vector3 &wo, const Vector3 &wi, Float lambda) {
    Vector3 h = Normalize(wo + wi);
    Float masking = wo.z * wi.z / (ProjectedArea(wo.z) * ProjectedArea(wi.z));
    return Tint(lambda) * NormalDistribution(h.z) * masking / (4 * wo.z * wi.z);
}

Vector3 HalfAt(Float x, Float y) {
    Float theta = Sqr(x) * Pi / 2;
    return SphericalDirection(std::sin(theta), std::cos(theta), (2 * y - 1) * Pi);
}

/// The tables that a measurement of the analytic surface would give.
std::string AnalyticFile(bool isotropic) {
    constexpr int kThetas = 24, kHalf = 96, kMeasured = 64;
    const int phis = isotropic ? 1 : 5;
    TensorWriter file;
    std::vector<float> theta, phi;
    for (int i = 0; i < kThetas; ++i) theta.push_back(1.5f * float(i) / (kThetas - 1));
    for (int i = 0; i < phis; ++i) phi.push_back(isotropic ? 0 : Pi * (2 * float(i) / float(phis - 1) - 1));
    auto knot = [](int i, int n) { return Float(i) / Float(n - 1); };
    std::vector<float> ndf, sigma, normals, luminance, spectra;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < kHalf; ++x) {
            Float cosTheta = HalfAt(knot(x, kHalf), 0).z;
            ndf.push_back(NormalDistribution(cosTheta));
            sigma.push_back(ProjectedArea(cosTheta));
        }
    for (float p : phi)
        for (float t : theta) {
            const Vector3 wo = SphericalDirection(std::sin(t), std::cos(t), p);
            std::vector<float> slice;
            for (int y = 0; y < kHalf; ++y)
                for (int x = 0; x < kHalf; ++x) {
                    Vector3 h = HalfAt(knot(x, kHalf), knot(y, kHalf));
                    Float solidAngle = knot(x, kHalf) * std::sqrt(std::max(Float(0), 1 - Sqr(h.z)));
                    slice.push_back(NormalDistribution(h.z) * std::max(Float(0), Dot(wo, h)) * solidAngle);
                }
            normals.insert(normals.end(), slice.begin(), slice.end());
            BilinearWarp warp(GridSlices(slice, kHalf, kHalf));
            const SliceBlend only{{0, 0, 0, 0}, {1, 0, 0, 0}};
            for (float lambda : kWavelengths)
                for (int y = 0; y < kMeasured; ++y)
                    for (int x = 0; x < kMeasured; ++x) {
                        Point2 at = warp.Sample({knot(x, kMeasured), knot(y, kMeasured)}, only).p;
                        Vector3 h = HalfAt(at.x, at.y), wi = Reflect(wo, h);
                        wi.z = std::max(wi.z, Float(1e-3));
                        Float value = Analytic(wo, Normalize(wi), lambda) * 4 * ProjectedArea(wo.z) * wi.z /
                                      NormalDistribution(Normalize(wo + wi).z);
                        spectra.push_back(value);
                        if (lambda == 500) luminance.push_back(value + 0.01f);
                    }
        }
    const uint64_t p = phi.size(), t = theta.size(), n = kHalf, m = kMeasured;
    file.Add("phi_i", {p}, phi);
    file.Add("theta_i", {t}, theta);
    file.Add("wavelengths", {kWavelengths.size()}, kWavelengths);
    file.Add("ndf", {2, n}, ndf);
    file.Add("sigma", {2, n}, sigma);
    file.Add("vndf", {p, t, n, n}, normals);
    file.Add("luminance", {p, t, m, m}, luminance);
    file.Add("spectra", {p, t, kWavelengths.size(), m, m}, spectra);
    return file.Bytes();
}

/// A small file; the field `name` has other values.
std::string SmallFile(const std::string &name, const std::vector<float> &values) {
    TensorWriter file;
    const auto add = [&](const char *field, std::vector<uint64_t> shape, const std::vector<float> &usual) {
        file.Add(field, std::move(shape), name == field ? values : usual);
    };
    const auto ones = [](size_t n) { return std::vector<float>(n, 1.0f); };
    add("phi_i", {3}, {-Pi, 0, Pi});
    add("theta_i", {2}, {0, 1.5f});
    add("wavelengths", {2}, {400, 700});
    add("ndf", {2, 2}, ones(4));
    add("sigma", {2, 2}, ones(4));
    add("vndf", {3, 2, 2, 2}, ones(24));
    add("luminance", {3, 2, 2, 2}, ones(24));
    add("spectra", {3, 2, 2, 2, 2}, ones(48));
    return file.Bytes();
}

class Measured : public FolderTest {
  protected:
    void Write(const std::string &bytes) { FolderTest::Write("measured", bytes); }
    const std::string path_ = Path("measured");
};

const Vector3 kViews[] = {DirectionAt(2, 30), DirectionAt(35, 200), DirectionAt(60, 80), DirectionAt(140, 10)};
/// At slices of the anisotropic table; between slices the lobe would be a mixture of two.
const Vector3 kViewsOfTheTable[] = {DirectionAt(2, 0), DirectionAt(35, 90), DirectionAt(60, 180),
                                    DirectionAt(140, 270)};

TEST_F(Measured, TableOfAnAnalyticSurfaceGivesItBack) {
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.4f);
    for (bool isotropic : {true, false}) {
        Write(AnalyticFile(isotropic));
        auto brdf = ReadMeasuredBrdf(path_);
        MeasuredBxdf lobe(*brdf, lambda);
        Rng rng(1);
        int compared = 0;
        for (const Vector3 &wo : isotropic ? kViews : kViewsOfTheTable)
            for (int i = 0; i < 500; ++i) {
                Vector3 wi = SampleCosineHemisphere(rng.Uniform2());
                if (wi.z < 0.2f) continue;
                if (wo.z < 0) wi = -wi;
                SampledSpectrum f = lobe.F(wo, wi, kRadiance);
                for (int k = 0; k < SpectrumSamples; ++k) {
                    Float expected = wo.z > 0 ? Analytic(wo, wi, lambda[k]) : Analytic(-wo, -wi, lambda[k]);
                    EXPECT_NEAR(f[k], expected, 0.06f * expected + 2e-3f) << isotropic << " " << wo.z << " " << wi.z;
                }
                ++compared;
                EXPECT_FALSE(lobe.F(wo, -wi, kRadiance));
            }
        EXPECT_GT(compared, 1000);
    }
}

TEST_F(Measured, SamplesFollowTheirDensity) {
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.4f);
    for (bool isotropic : {true, false}) {
        Write(AnalyticFile(isotropic));
        auto brdf = ReadMeasuredBrdf(path_);
        MeasuredBxdf lobe(*brdf, lambda);
        for (const Vector3 &wo : kViews) {
            double mass;
            double p = DirectionTest([&](Rng &rng) { return DirectionOf(SampleLobe(lobe, wo, rng, kRadiance)); },
                                     [&](const Vector3 &wi) { return lobe.Pdf(wo, wi, kRadiance); }, 10000, 10, &mass);
            EXPECT_GT(p, SidakAlpha(1e-4, 8)) << isotropic << " " << wo.z;
            EXPECT_LT(mass, 1.01);
            EXPECT_GT(mass, 0.7);
            Rng rng(2);
            for (int i = 0; i < 300; ++i) {
                auto s = lobe.Sample(wo, 0, rng.Uniform2(), kRadiance);
                if (!s || std::abs(s->wi.z) < 0.05f) continue;
                EXPECT_NEAR(lobe.Pdf(wo, s->wi, kRadiance), s->pdf, 0.02f * s->pdf + 1e-3f);
                EXPECT_NEAR(lobe.F(wo, s->wi, kRadiance)[1], s->f[1], 0.02f * s->f[1] + 1e-3f);
            }
        }
    }
}

TEST_F(Measured, MaterialReadsItsFileAndErrorsNameIt) {
    Write(AnalyticFile(true));
    Workshop shop;
    MaterialPtr m = shop.Make("measured", Params("m").String("filename", path_));
    SurfacePoint s = TestPoint();
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.4f);
    Vector3 wi = Normalize(s.n + s.wo);
    Frame frame = Frame::FromXZ(s.shading.dpdu, s.shading.n);
    EXPECT_NEAR(m->GetBsdf(s, lambda).F(s.wo, wi)[2], Analytic(frame.ToLocal(s.wo), frame.ToLocal(wi), lambda[2]),
                0.03f);
    EXPECT_TRUE(shop.sink.All().empty());

    ExpectErrorAt([&] { shop.Make("measured", Params("m", 3)); }, 3, {"\"string filename\" is missing"});
    const auto expect = [&](const std::string &bytes, const std::string &words) {
        Write(bytes);
        ExpectErrorAt([&] { shop.Make("measured", Params("m", 3).String("filename", path_)); }, 4, {words});
    };
    expect("tensor_file", "header is missing");
    const std::string bytes = AnalyticFile(true);
    expect(bytes.substr(0, bytes.size() - 1), "is shorter than what it announces");
    for (size_t length = 0; length < 300; length += 7) expect(bytes.substr(0, length), "tensor file");
    TensorWriter few;
    few.Add("phi_i", {1}, {0});
    expect(few.Bytes(), "field \"theta_i\" is missing");
    few.Add("theta_i", {2}, {1, 0});
    expect(few.Bytes(), "must increase");
    TensorWriter infinite;
    infinite.Add("phi_i", {1}, {std::numeric_limits<float>::infinity()});
    expect(infinite.Bytes(), "field \"phi_i\": value 0 is inf");
    // Two fields share the same bytes: so a small file can need much memory.
    std::string shared = few.Bytes();
    const size_t second = shared.find("theta_i") + 7 + 2 + 1, first = shared.find("phi_i") + 5 + 2 + 1;
    uint64_t size = shared.size() / 4;
    for (size_t field : {first, second}) std::memcpy(shared.data() + field, std::string(8, '\0').data(), 8);
    for (size_t field : {first, second}) std::memcpy(shared.data() + field + 8, &size, 8);
    expect(shared, "has fields that overlap");
}

TEST_F(Measured, ValuesThatNoMeasurementHasAreErrors) {
    Write(SmallFile("", {}));
    EXPECT_NO_THROW(ReadMeasuredBrdf(path_));
    const auto expect = [&](const std::string &name, const std::vector<float> &values, const std::string &words) {
        Write(SmallFile(name, values));
        ExpectWords(MessageOf([&] { ReadMeasuredBrdf(path_); }), {"field \"" + name + "\" " + words});
    };
    for (const char *name : {"ndf", "sigma"}) {
        expect(name, {1, 1, -1, 1}, "holds a negative value");
        expect(name, {0, 0, 0, 0}, "is 0 everywhere");
    }
    expect("theta_i", {0, 90}, "must hold angles from 0 to Pi / 2");
    expect("theta_i", {-1, 1}, "must hold angles from 0 to Pi / 2");
    expect("phi_i", {0, Pi, 2 * Pi}, "must go from -Pi to Pi");
    expect("wavelengths", {0.4f, 0.7f}, "holds none from 360 to 830 nm");
    expect("wavelengths", {900, 1000}, "holds none from 360 to 830 nm");
}

}  // namespace
}  // namespace pbrt::test
