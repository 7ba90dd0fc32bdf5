// Rays that leave lights (SampleLe) and their densities, for every type of light.
#include "light_test_support.h"
#include "pbrt/lights/environment_light.h"

namespace pbrt::test {
namespace {

const Transform kTurned = Transform::Translate({0.3f, -0.2f, 0.1f}) * Transform::Rotate(33, {1, 3, 2});
const Transform kStretched = kTurned * Transform::Scale({1.6f, 0.7f, 1});

struct EmissionCase {
    std::string name, type{};
    Params params{};
    Transform ctm = kTurned;
    bool powerIsExact = true;              ///< Phi is the power itself, not an estimate as in stock pbrt-v4
    Image image{};                         ///< the light's file
    std::shared_ptr<const Shape> shape{};  ///< of area lights
    uint32_t part = 0;
    bool isCut = false;  ///< a part of the shape is cut away
};
void PrintTo(const EmissionCase &c, std::ostream *out) { *out << c.name; }

Rgb Picture(int x, int y) {
    if (x == 5 && y == 2) return {9, 7, 2};
    return {0.1f * Float(x), 0.3f, 0.05f * Float(y)};
}

std::vector<EmissionCase> EmissionCases() {
    const Image grey = GreyImage(8, [](int x, int y) { return x == 3 && y == 4 ? 6 : 0.1f * Float(x); });
    const std::vector<Float> portal = {-1, -0.5f, 1, -1, 0.5f, 1, 1, 0.5f, 1, 1, -0.5f, 1},
                             patch = {-1, -1, 0, 1, -1, 0.5f, -0.4f, 1, 0.2f, 0.3f, 0.8f, -0.6f};
    const Params ball = Params().Number("radius", 0.7f);
    MeshData mesh;
    mesh.p = {{-1, -1, 0}, {1, -1, 0.2f}, {0.3f, 1, 0}, {-0.9f, 0.8f, 0.4f}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return {
        {"point", "point", Params().Point("from", {0.2f, 0.1f, 0.3f})},
        {"spot", "spot", Cone(50, 20)},
        {"spotWithoutEdge", "spot", Cone(50, 0)},
        {"spotOfEdgeOnly", "spot", Cone(70, 70)},
        {"spotBeyondAHalfSpace", "spot", Cone(120, 30)},
        {"spotStretched", "spot", Cone(50, 20), kStretched, false},
        {"goniometric", "goniometric", Params(), kTurned, true, grey},
        {"goniometricStretched", "goniometric", Params(), kStretched, false, grey},
        {"projection", "projection", Params().Number("fov", 70), kTurned, false, RgbImage({8, 4}, Picture)},
        {"distant", "distant", Params().Point("from", {1, 2, 3}).Point("to", {0, 0, 0})},
        {"skyOfOneColour", "infinite", Params().Rgb("L", 1, 2, 3)},
        {"sky", "infinite", Params(), kTurned, true, RgbImage({8, 8}, Picture)},
        {"portal", "infinite", Params().Floats(ParamType::Point3, "portal", portal), Transform::Rotate(40, {1, 2, 3}),
         false, RgbImage({16, 16}, Picture)},
        {.name = "triangle", .params = Params().Number("scale", 2), .shape = Triangle(kTurned)},
        {.name = "triangleOfAMesh", .shape = std::make_shared<TriangleMesh>(mesh, kTurned, false), .part = 1},
        {.name = "triangleOfTwoSides", .params = Params().Bool("twosided", true), .shape = Triangle(kTurned)},
        {.name = "sphere", .shape = MakeShape("sphere", ball, kTurned)},
        {.name = "egg", .shape = MakeShape("sphere", ball, kStretched)},
        {.name = "patch",
         .powerIsExact = false,
         .shape = MakeShape("bilinearmesh", Params().Floats(ParamType::Point3, "P", patch), kTurned)},
        {.name = "triangleWithHoles", .powerIsExact = false, .shape = Triangle(kTurned), .isCut = true},
    };
}

class Emission : public testing::TestWithParam<EmissionCase> {
  protected:
    Emission() {
        const EmissionCase &c = GetParam();
        Params params = c.params;
        if (c.image) params.String("filename", file_.emplace("emission.exr", c.image).Path());
        light_ = c.shape ? MakeAreaLight(params, *c.shape, c.isCut ? &cut_ : nullptr) : Make(c.type, params, c.ctm);
        light_->Preprocess({0.1f, 0.2f, 0.1f}, 4);
    }
    LightComponent TheLight() const { return {*light_, GetParam().part}; }
    static Float Flux(const LightLeSample &s) {
        const Float cosine = s.n == Normal3(0) ? 1 : AbsDot(s.n, s.ray.d);
        return s.L.Average() * cosine / (s.pdfPosition * s.pdfDirection);
    }

  private:
    const CutTexture cut_{0.4f, 0.8f};
    std::optional<TemporaryImage> file_;
    std::unique_ptr<Light> light_;
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
        const auto li = TheLight().SampleLi(At(p), rng.Uniform2(), kLambda, false);
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
        const Point2i at = PixelAt(EqualAreaSphereToSquare(w), {kN, kN});
        return at.y * kN + at.x;
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
            const Vector3 w = EqualAreaSquareToSphere(PixelCenter(x, y, Point2i(kN * kSub)));
            const LightLePdf pdf = TheLight().PdfLe(isPortal ? Point3(0, 0, 1) : any->ray.o, any->n,
                                                    isLocal ? Frame::FromZ(any->n).FromLocal(w) : w);
            const double mass = double(pdf.direction) * 4 * std::numbers::pi / (kN * kSub * kN * kSub);
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

INSTANTIATE_TEST_SUITE_P(All, Emission, testing::ValuesIn(EmissionCases()), testing::PrintToStringParamName());

}  // namespace
}  // namespace pbrt::test
