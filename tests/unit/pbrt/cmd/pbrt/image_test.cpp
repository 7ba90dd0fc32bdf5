#include <signal.h>

#include <algorithm>
#include <glm/vec4.hpp>
#include <sstream>

#include "program.h"

namespace pbrt::test {

class Images : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        Write("scene.pbrt", SmallScene());
    }
};

TEST_F(Images, SeedChoosesTheNoise) {
    const ImageFile first = Render("--seed 1 scene.pbrt");
    EXPECT_TRUE(SamePixels(first, Render("--seed 1 scene.pbrt")));
    EXPECT_FALSE(SamePixels(first, Render("--seed 2 scene.pbrt")));
    EXPECT_EQ(IntOf(first, "pbrt.seed"), 1);
    EXPECT_TRUE(SamePixels(Render("--seed 0 scene.pbrt"), Render("scene.pbrt")));
}

TEST_F(Images, HeaderTellsHowTheImageCameAbout) {
    const ImageFile file = Render("--spp 3 scene.pbrt");
    EXPECT_EQ(IntOf(file, "samplesPerPixel"), 3);
    EXPECT_GT(NumberOf(file, "renderTimeSeconds"), 0);
    EXPECT_LT(NumberOf(file, "renderTimeSeconds"), 60);
    EXPECT_EQ(TextOf(file, "lightSampler"), "bvh");
    EXPECT_EQ(TextOf(file, "pbrt.integrator"), "path");
    EXPECT_EQ(IntOf(file, "pbrt.maxDepth"), 3);
    EXPECT_TRUE(Has(TextOf(file, "pbrt.commandLine"), "--outfile out.exr --spp 3 scene.pbrt"));
    EXPECT_TRUE(Has(TextOf(file, "pbrt.version"), "pbrt"));
    EXPECT_FALSE(file.metadata.attributes.contains("pbrt.interrupted"));
}

TEST_F(Images, HeaderMatricesMapTheWorldIntoThePicture) {
    const ImageFile file = Render("--spp 1 scene.pbrt");
    auto map = [&](const char *name, glm::vec4 p) {
        auto it = file.metadata.attributes.find(name);
        EXPECT_NE(it, file.metadata.attributes.end()) << name;
        const glm::vec4 q = std::get<glm::mat4>(it->second) * p;
        return Point3(q.x / q.w, q.y / q.w, q.z / q.w);
    };
    // LookAt 0 1 -5  0 0 0  0 1 0
    const Point3 eye = map("worldToCamera", {0, 1, -5, 1}), target = map("worldToCamera", {0, 0, 0, 1});
    EXPECT_NEAR(Distance(eye, Point3(0)), 0, 1e-5f);
    EXPECT_NEAR(Distance(target, Point3(0, 0, std::sqrt(Float(26)))), 0, 1e-5f);
    const Point3 middle = map("worldToNDC", {0, 0, 0, 1}), right = map("worldToNDC", {1, 0, 0, 1});
    EXPECT_NEAR(middle.x, 0.5f, 1e-5f);
    EXPECT_NEAR(middle.y, 0.5f, 1e-5f);
    // As stock: 0 to 1 is the field of view (40 degrees along the shorter axis), not the longer side of the picture.
    EXPECT_NEAR(right.x - middle.x, 0.5f / std::sqrt(Float(26)) / std::tan(Float(20 * 3.14159265 / 180)), 1e-5f);
    EXPECT_NEAR(right.y, 0.5f, 1e-5f);
}

TEST_F(Images, ErrorAgainstAReferenceFallsWaveByWave) {
    Render("--spp 400 --seed 99 scene.pbrt", "reference.exr");
    const ImageFile file =
        Render("--spp 64 --mse-reference-image reference.exr --mse-reference-out mse.txt scene.pbrt");
    std::istringstream lines(Read("mse.txt"));
    std::vector<int> spp;
    std::vector<double> mse;
    for (std::string line; std::getline(lines, line);) {
        int samples = 0;
        double error = 0;
        ASSERT_EQ(std::sscanf(line.c_str(), "%d, %lf", &samples, &error), 2) << line;
        spp.push_back(samples);
        mse.push_back(error);
    }
    ASSERT_GE(spp.size(), 5u);
    EXPECT_EQ(spp.front(), 1);
    EXPECT_EQ(spp.back(), 64);
    EXPECT_TRUE(std::is_sorted(spp.begin(), spp.end(), std::less_equal<int>()));
    EXPECT_GT(mse.back(), 0);
    EXPECT_LT(mse.back(), mse.front() / 8);
    EXPECT_LT(mse[mse.size() / 2], mse.front());
    EXPECT_NEAR(NumberOf(file, "MSE"), mse.back(), 1e-5 * mse.back());
}

TEST_F(Images, PartialImagesShowTheWavesSoFar) {
    const pid_t pid = Start("--spp 100000000 --write-partial-images --outfile out.exr scene.pbrt");
    EXPECT_TRUE(WaitUntil([&] { return Exists("out.exr"); }));
    const ImageFile partial = ReadImage(Path("out.exr"));
    EXPECT_GE(IntOf(partial, "samplesPerPixel"), 1);
    EXPECT_LT(IntOf(partial, "samplesPerPixel"), 100000000);
    EXPECT_FALSE(partial.metadata.attributes.contains("pbrt.interrupted"));
    kill(pid, SIGINT);
    EXPECT_EQ(Wait(pid).status, 130);
    const ImageFile final = ReadImage(Path("out.exr"));
    EXPECT_EQ(IntOf(final, "pbrt.interrupted"), 1);
    EXPECT_GE(IntOf(final, "samplesPerPixel"), IntOf(partial, "samplesPerPixel"));
    EXPECT_EQ(Files(), (std::vector<std::string>{"out.exr", "scene.pbrt"})) << "temporary files must be gone";
}

}  // namespace pbrt::test
