// Rays that leave lights (SampleLe) and their densities, for every type of light.
#include <gtest/gtest.h>

#include "light_test_support.h"
#include "pbrt/lights/environment_light.h"

namespace pbrt::test {
namespace {

const Transform kTurned = Transform::Translate({0.3f, -0.2f, 0.1f}) * Transform::Rotate(33, {1, 3, 2});
const Transform kStretched = kTurned * Transform::Scale({1.6f, 0.7f, 1});

/// Half of every primitive, u < 0.4, is cut away.
class CutTexture final : public FloatTexture {
  public:
    Float Evaluate(const TextureContext &c) const override { return c.uv.x < Float(0.4) ? Float(0) : Float(0.8); }
};

/// A light with what must outlive it.
struct Shooter {
    std::vector<std::unique_ptr<TemporaryImage>> files;
    std::shared_ptr<const Shape> shape;
    CutTexture alpha;
    std::unique_ptr<Light> light;
    uint32_t part = 0;
};
struct EmissionCase {
    std::string name;
    std::function<void(Shooter &)> make;
    bool powerIsExact = true;  ///< Phi is the power itself, not an estimate as in stock pbrt-v4
};
void PrintTo(const EmissionCase &c, std::ostream *out) { *out << c.name; }

Rgb Picture(int x, int y) {
    if (x == 5 && y == 2) return {9, 7, 2};
    return {0.1f * Float(x), 0.3f, 0.05f * Float(y)};
}
const std::string &File(Shooter &s, const Image &image) {
    s.files.push_back(std::make_unique<TemporaryImage>("emission.exr", image));
    return s.files.back()->Path();
}
Image Grey() {
    Image image(PixelFormat::Float, {8, 8}, {"Y"});
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) image.Set({x, y}, 0, x == 3 && y == 4 ? 6 : 0.1f * Float(x));
    return image;
}
void Area(Shooter &s, std::shared_ptr<const Shape> shape, const Params &params, bool cut = false) {
    s.shape = std::move(shape);
    const Shape *const shapes[] = {s.shape.get()};
    s.light = MakeAreaMaker(params)(shapes, cut ? &s.alpha : nullptr);
}
const EmissionCase kEmissionCases[] = {
    {"point",
     [](Shooter &s) {
         s.light = Make("point", Params().Point("from", {0.2f, 0.1f, 0.3f}), kTurned);
     }},
    {"spot",
     [](Shooter &s) {
         s.light = Make("spot", Params().Number("coneangle", 50).Number("conedeltaangle", 20), kTurned);
     }},
    {"spotWithoutEdge",
     [](Shooter &s) { s.light = Make("spot", Params().Number("coneangle", 50).Number("conedeltaangle", 0), kTurned); }},
    {"spotOfEdgeOnly",
     [](Shooter &s) {
         s.light = Make("spot", Params().Number("coneangle", 70).Number("conedeltaangle", 70), kTurned);
     }},
    {"spotBeyondAHalfSpace",
     [](Shooter &s) {
         s.light = Make("spot", Params().Number("coneangle", 120).Number("conedeltaangle", 30), kTurned);
     }},
    {"spotStretched",
     [](Shooter &s) {
         s.light = Make("spot", Params().Number("coneangle", 50).Number("conedeltaangle", 20), kStretched);
     },
     false},
    {"goniometric",
     [](Shooter &s) { s.light = Make("goniometric", Params().String("filename", File(s, Grey())), kTurned); }},
    {"goniometricStretched",
     [](Shooter &s) { s.light = Make("goniometric", Params().String("filename", File(s, Grey())), kStretched); },
     false},
    {"projection",
     [](Shooter &s) {
         s.light = Make("projection", Params().String("filename", File(s, RgbImage({8, 4}, Picture))).Number("fov", 70),
                        kTurned);
     },
     false},
    {"distant",
     [](Shooter &s) {
         s.light = Make("distant", Params().Point("from", {1, 2, 3}).Point("to", {0, 0, 0}), kTurned);
     }},
    {"skyOfOneColour", [](Shooter &s) { s.light = Make("infinite", Params().Rgb("L", 1, 2, 3), kTurned); }},
    {"sky",
     [](Shooter &s) {
         s.light = Make("infinite", Params().String("filename", File(s, RgbImage({8, 8}, Picture))), kTurned);
     }},
    {"portal",
     [](Shooter &s) {
         Params params;
         params.String("filename", File(s, RgbImage({16, 16}, Picture)))
             .Floats(ParamType::Point3, "portal", {-1, -0.5f, 1, -1, 0.5f, 1, 1, 0.5f, 1, 1, -0.5f, 1});
         s.light = Make("infinite", params, Transform::Rotate(40, {1, 2, 3}));
     },
     false},
    {"triangle", [](Shooter &s) { Area(s, Triangle(kTurned), Params().Number("scale", 2)); }},
    {"triangleOfAMesh",
     [](Shooter &s) {
         MeshData data;
         data.p = {{-1, -1, 0}, {1, -1, 0.2f}, {0.3f, 1, 0}, {-0.9f, 0.8f, 0.4f}};
         data.indices = {0, 1, 2, 0, 2, 3};
         Area(s, std::make_shared<TriangleMesh>(data, kTurned, false), Params());
         s.part = 1;
     }},
    {"triangleOfTwoSides", [](Shooter &s) { Area(s, Triangle(kTurned), Params().Bool("twosided", true)); }},
    {"sphere", [](Shooter &s) { Area(s, MakeShape("sphere", Params().Number("radius", 0.7f), kTurned), Params()); }},
    {"egg", [](Shooter &s) { Area(s, MakeShape("sphere", Params().Number("radius", 0.7f), kStretched), Params()); }},
    {"patch",
     [](Shooter &s) {
         Params patch;
         patch.Floats(ParamType::Point3, "P", {-1, -1, 0, 1, -1, 0.5f, -0.4f, 1, 0.2f, 0.3f, 0.8f, -0.6f});
         Area(s, MakeShape("bilinearmesh", patch, kTurned), Params());
     },
     false},
    {"triangleWithHoles", [](Shooter &s) { Area(s, Triangle(kTurned), Params(), true); }, false},
};

class Emission : public testing::TestWithParam<EmissionCase> {
  protected:
    Emission() {
        GetParam().make(shooter_);
        shooter_.light->Preprocess({0.1f, 0.2f, 0.1f}, 4);
    }
    LightComponent TheLight() const { return {*shooter_.light, shooter_.part}; }
    static Float Flux(const LightLeSample &s) {
        const Float cosine = s.n == Normal3(0) ? 1 : AbsDot(s.n, s.ray.d);
        return s.L.Average() * cosine / (s.pdfPosition * s.pdfDirection);
    }

  private:
    Shooter shooter_;
};

TEST_P(Emission, SamplesCarryThePower) {
    Rng rng(5);
    RunningStatistics flux;
    for (int i = 0; i < 60000; ++i) {
        const auto s = TheLight().SampleLe(rng.Uniform2(), rng.Uniform2(), kLambda);
        flux.Add(s ? double(Flux(*s)) : 0);
    }
    const double power = TheLight().Phi(kLambda).Average();
    ASSERT_GT(power, 0);
    if (GetParam().powerIsExact) {
        EXPECT_NEAR(flux.mean, power, 4.5 * flux.StandardError() + 1e-4 * power);
    }
    // What is drawn follows what leaves, up to colour and what is cut away.
    EXPECT_LT(flux.StandardError() * std::sqrt(60000.0), 1.5 * flux.mean);
}

TEST_P(Emission, DensitiesAreThoseOfTheSamples) {
    Rng rng(6);
    int drawn = 0, wrong = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto s = TheLight().SampleLe(rng.Uniform2(), rng.Uniform2(), kLambda);
        if (!s) continue;
        ++drawn;
        EXPECT_NEAR(Length(s->ray.d), 1, 1e-5f);
        // The densities of a ray do not depend on where it is met; only a surface is met where it is.
        const Point3 p = s->n == Normal3(0) ? s->ray(Float(0.7)) : s->ray.o;
        const LightLePdf pdf = TheLight().PdfLe(p, s->n, s->ray.d);
        if (TheLight().Kind() == LightKind::DeltaPosition) {
            EXPECT_EQ(s->pdfPosition, 1);
            EXPECT_EQ(pdf.position, 0);
        } else {
            EXPECT_NEAR(pdf.position / s->pdfPosition, 1, 2e-3f);
        }
        if (TheLight().Kind() == LightKind::DeltaDirection) {
            EXPECT_EQ(s->pdfDirection, 1);
            EXPECT_EQ(pdf.direction, 0);
        } else {
            // Directions at the border of two pixels of an image may count as one's or the other's.
            if (!(std::abs(pdf.direction / s->pdfDirection - 1) < 2e-3f)) ++wrong;
        }
    }
    EXPECT_GT(drawn, 600);
    EXPECT_LE(wrong, 4);
}

TEST_P(Emission, LightReachesAReceiverAsItDoesBySamplingTheLight) {
    // A square receiver near the middle of the scene; light through both of its sides counts. Slow, but simple.
    const Frame frame = Frame::FromZ(Normalize(Vector3(0.4f, -0.3f, 0.8f)));
    const bool isFarAway = TheLight().Kind() == LightKind::Infinite || TheLight().Kind() == LightKind::DeltaDirection;
    const Point3 middle = isFarAway ? Point3(0.4f, 0.3f, 0) : Point3(0.5f, 0.4f, 1.9f);
    constexpr Float kHalf = 1;
    Rng rng(7);
    RunningStatistics shot, gathered;
    for (int i = 0; i < 150000; ++i) {
        const auto s = TheLight().SampleLe(rng.Uniform2(), rng.Uniform2(), kLambda);
        double flux = 0;
        if (s) {
            const Float along = Dot(s->ray.d, frame.z), t = Dot(middle - s->ray.o, frame.z) / along;
            const Vector3 at = frame.ToLocal(s->ray(t) - middle);
            if (t > 0 && std::abs(at.x) < kHalf && std::abs(at.y) < kHalf) flux = double(Flux(*s));
        }
        shot.Add(flux);
        const Point2 u = rng.Uniform2();
        const Point3 p = middle + frame.x * ((2 * u.x - 1) * kHalf) + frame.y * ((2 * u.y - 1) * kHalf);
        LightSampleContext from = At(p);
        const auto li = TheLight().SampleLi(from, rng.Uniform2(), kLambda, false);
        double irradiance = 0;
        if (li && li->pdf > 0)
            irradiance = double(li->L.Average() * AbsDot(li->wi, frame.z) / li->pdf * Sqr(2 * kHalf));
        gathered.Add(irradiance);
    }
    ASSERT_GT(gathered.mean, 0);
    const double error = std::hypot(shot.StandardError(), gathered.StandardError());
    EXPECT_NEAR(shot.mean, gathered.mean, 4.5 * error);
    EXPECT_LT(error, 0.08 * gathered.mean) << "the test sees nothing";
}

TEST_P(Emission, DirectionsFollowTheirDensity) {
    if (TheLight().Kind() == LightKind::DeltaDirection) GTEST_SKIP() << "one direction only";
    // Area lights: the density depends on the normal, so the cells are around the normal of the sample.
    constexpr int kN = 12, kSub = 24, kSamples = 60000;
    const bool isLocal = TheLight().Surface().shape != nullptr;
    std::vector<double> observed(kN * kN), expected(kN * kN);
    Rng rng(8);
    int drawn = 0;
    auto cell = [](const Vector3 &w) {
        const Point2 st = EqualAreaSphereToSquare(w);
        const int x = std::clamp(int(st.x * kN), 0, kN - 1), y = std::clamp(int(st.y * kN), 0, kN - 1);
        return size_t(y * kN + x);
    };
    std::optional<LightLeSample> any;
    // A point of the portal, which all its rays cross.
    const EnvironmentLight *environment = TheLight().Parent().AsEnvironment();
    const bool isPortal = environment && environment->Opening();
    for (int i = 0; i < kSamples; ++i) {
        const auto s = TheLight().SampleLe(rng.Uniform2(), rng.Uniform2(), kLambda);
        if (!s) continue;
        any = s;
        ++drawn;
        observed[cell(isLocal ? Frame::FromZ(s->n).ToLocal(s->ray.d) : s->ray.d)] += 1;
    }
    ASSERT_TRUE(any);
    double total = 0;
    for (int y = 0; y < kN * kSub; ++y)
        for (int x = 0; x < kN * kSub; ++x) {
            const Vector3 w =
                EqualAreaSquareToSphere({(Float(x) + 0.5f) / (kN * kSub), (Float(y) + 0.5f) / (kN * kSub)});
            const Vector3 render = isLocal ? Frame::FromZ(any->n).FromLocal(w) : w;
            const double mass =
                double(TheLight().PdfLe(isPortal ? Point3(0, 0, 1) : any->ray.o, any->n, render).direction) * 4 *
                std::numbers::pi / (kN * kSub * kN * kSub);
            expected[y / kSub * kN + x / kSub] += mass;
            total += mass;
        }
    // Edges of cones and images do not follow the cells.
    EXPECT_NEAR(total, 1, 0.01);
    for (double &e : expected) e *= drawn / total;
    double distance = 0;
    for (size_t i = 0; i < observed.size(); ++i) distance += std::abs(observed[i] - expected[i]);
    // Of 60,000 samples in 144 cells about 4 % lie elsewhere by chance.
    EXPECT_LT(distance / drawn, 0.06);
}

INSTANTIATE_TEST_SUITE_P(All, Emission, testing::ValuesIn(kEmissionCases),
                         [](const auto &test) { return test.param.name; });

}  // namespace
}  // namespace pbrt::test
