#include "data_sets/data_set.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "data_sets/visible_in_both.h"
#include "io/image_file.h"
#include "io/pfm.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

constexpr int kWidth = 6;
constexpr int kHeight = 2;

bool isUnknown(float value) { return std::isnan(value); }

double difference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

/// Writes data sets with pairs of kWidth x kHeight pixels.
class DataSetTest : public testing::Test {
 protected:
  /// Path of a file in the temporary folder; creates its folders.
  std::string place(const std::string& name) const {
    fs::create_directories(fs::path(folder_.file(name)).parent_path());
    return folder_.file(name);
  }

  void writePair(const std::string& left, const std::string& right) const {
    writeImage(place(left), cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(10, 20, 30)));
    writeImage(place(right), cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(77)));
  }

  void writeMiddleburyScene(const std::string& scene) const {
    writePair(scene + "/im0.png", scene + "/im1.png");
    writePfm(place(scene + "/disp0GT.pfm"), cv::Mat::ones(kHeight, kWidth, CV_32FC1));
    writeMiddleburyCalibration(place(scene + "/calib.txt"),
                               {500, 2, 2, 1, 0.1, kWidth, kHeight, 4});
  }

  void writeMiddlebury2005Scene(const std::string& scene) const {
    writePair(scene + "/view1.png", scene + "/view5.png");
    writeImage(place(scene + "/disp1.png"), disp1_);
    writeImage(place(scene + "/disp5.png"), disp5_);
  }

  void writeKittiScene(const std::string& scene, const std::string& images, const std::string& left,
                       const std::string& right, const std::string& truth) const {
    writePair(images + left + "/" + scene + ".png", images + right + "/" + scene + ".png");
    writeImage(place(images + truth + "/" + scene + ".png"), noc_);
  }

  DataSet open(const std::string& kind, const std::string& folder,
               Truth truth = Truth::kRequired) const {
    return DataSet::open(kind + ":" + folder_.file(folder), truth);
  }

  /// The error message for reading `scene`; must contain `file`.
  std::string readError(const DataSet& data_set, const std::string& scene,
                        const std::string& file) const {
    std::string text = errorText([&] { data_set.read(scene); });
    EXPECT_TRUE(mentions(text, {folder_.file(file)}));
    return text;
  }

  const TemporaryFolder folder_;
  // Middlebury 2005, thirds of a pixel. Row 0: unknown, outside the image, confirmed exactly,
  // within 1 px, more than 1 px off, unknown in the right image.
  const cv::Mat disp1_ =
      (cv::Mat_<std::uint8_t>(kHeight, kWidth) << 0, 6, 6, 6, 6, 6, 3, 3, 3, 3, 3, 3);
  const cv::Mat disp5_ =
      (cv::Mat_<std::uint8_t>(kHeight, kWidth) << 6, 9, 10, 0, 6, 6, 3, 3, 3, 3, 3, 3);
  const cv::Mat noc_ =
      (cv::Mat_<std::uint16_t>(kHeight, kWidth) << 0, 0, 512, 128, 0, 1, 0, 0, 0, 0, 0, 256);
};

TEST_F(DataSetTest, ReadsMiddleburyV3) {
  writeMiddleburyScene("v3/Vintage");
  writeMiddleburyScene("v3/Teddy");
  const DataSet data_set = open("middlebury_v3", "v3");
  EXPECT_EQ(data_set.kind(), "middlebury_v3");
  EXPECT_EQ(data_set.title(), "Middlebury v3");
  EXPECT_EQ(data_set.scenes(), (Names{"Teddy", "Vintage"}));
  EXPECT_EQ(data_set.weight("Teddy"), 1.0);
  EXPECT_EQ(data_set.weight("Vintage"), 0.5);
  const StereoScene scene = data_set.read("Teddy");
  EXPECT_EQ(scene.name, "Teddy");
  EXPECT_EQ(scene.calibration.disparities, 4);
  EXPECT_EQ(scene.right.at<uchar>(1, 1), 77);
}

TEST_F(DataSetTest, CorrectIsWhatTheTruthCanTell) {
  writeMiddleburyScene("v3/Teddy");
  writeMiddlebury2005Scene("2005/Art");
  writeKittiScene("000007_10", "2012/", "image_0", "image_1", "disp_noc");
  writeKittiScene("000001_10", "2015/", "image_2", "image_3", "disp_noc_0");
  EXPECT_EQ(open("middlebury_v3", "v3").correctPx(), 1.0);
  EXPECT_EQ(open("middlebury_2005", "2005").correctPx(), 1.0);
  EXPECT_EQ(open("kitti2012", "2012").correctPx(), 3.0);
  EXPECT_EQ(open("kitti2015", "2015").correctPx(), 3.0);
}

TEST_F(DataSetTest, HalfWeightsAreTheOfficialOnes) {
  writeMiddleburyScene("v3/Teddy");
  writeMiddlebury2005Scene("2005/Art");
  const DataSet v3 = open("middlebury_v3", "v3");
  for (const char* name : {"PianoL", "Playroom", "Playtable", "Shelves", "Vintage"}) {
    EXPECT_EQ(v3.weight(name), 0.5) << name;
    EXPECT_EQ(open("middlebury_2005", "2005").weight(name), 1.0) << name;
  }
  for (const char* name : {"Adirondack", "ArtL", "Jadeplant", "Motorcycle", "MotorcycleE", "Piano",
                           "Pipes", "PlaytableP", "Recycle", "Teddy"}) {
    EXPECT_EQ(v3.weight(name), 1.0) << name;
  }
}

TEST_F(DataSetTest, ReadsMiddlebury2005) {
  writeMiddlebury2005Scene("2005/Art");
  const StereoScene scene = open("middlebury_2005", "2005").read("Art");
  EXPECT_TRUE(isUnknown(scene.truth.at<float>(0, 0)));
  EXPECT_FLOAT_EQ(scene.truth.at<float>(0, 1), 2.0F);
  EXPECT_FLOAT_EQ(scene.truth.at<float>(1, 0), 1.0F);
  const cv::Mat visible =
      (cv::Mat_<uchar>(kHeight, kWidth) << 0, 0, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255);
  EXPECT_EQ(difference(scene.visible, visible), 0.0) << scene.visible;
  EXPECT_EQ(scene.calibration.disparities, kWidth);  // 85, limited to the width
  EXPECT_EQ(scene.calibration.width, kWidth);
  EXPECT_EQ(scene.calibration.height, kHeight);
}

const std::vector<std::pair<std::string, double>> kKindsOf2005 = {
    {"middlebury_2005", 3}, {"middlebury_2005_half", 2}, {"middlebury_2005_full", 1}};

TEST_F(DataSetTest, RejectsImagesOf2005ThatAreTooWideForTheirSize) {
  for (const auto& [width, size, kind] :
       std::vector<std::tuple<int, std::size_t, std::string>>{{465, 0, "middlebury_2005"},
                                                              {620, 1, "middlebury_2005_half"},
                                                              {1282, 2, "middlebury_2005_full"}}) {
    writeImage(place(kind + "/Aloe/view1.png"), cv::Mat::zeros(1, width, CV_8UC1));
    writeImage(place(kind + "/Aloe/view5.png"), cv::Mat::zeros(1, width, CV_8UC1));
    writeImage(place(kind + "/Aloe/disp1.png"), cv::Mat(1, width, CV_8UC1, cv::Scalar(60)));
    const StereoScene scene = open(kind, kind).read("Aloe");
    EXPECT_FLOAT_EQ(scene.truth.at<float>(0, width - 1),
                    60 / static_cast<float>(kKindsOf2005[size].second));
    EXPECT_EQ(scene.calibration.disparities, (std::vector<int>{85, 128, 255}[size]));
    for (std::size_t other = 0; other < size; ++other) {
      EXPECT_TRUE(mentions(
          readError(open(kKindsOf2005[other].first, kind), "Aloe", kind + "/Aloe/view1.png"),
          {std::to_string(width) + " px", "Use the kind " + kind + "."}));
    }
  }
}

/// A crop of a larger image is not too wide, but with the wrong divisor the images do not match.
TEST_F(DataSetTest, FindsThatTheTruthOf2005IsOfAnotherSize) {
  cv::Mat image(20, 200, CV_8UC1);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 256);
  for (const auto& [kind, divisor] : kKindsOf2005) {
    const int shift = 12;
    writeImage(place(kind + "/Aloe/view1.png"), image.colRange(0, 200 - shift));
    writeImage(place(kind + "/Aloe/view5.png"), image.colRange(shift, 200));
    writeImage(place(kind + "/Aloe/disp1.png"),
               cv::Mat(20, 200 - shift, CV_8UC1, cv::Scalar(shift * divisor)));
    EXPECT_EQ(open(kind, kind).read("Aloe").truth.at<float>(3, 50), shift);
    for (const auto& other : kKindsOf2005) {
      if (other.first != kind) {
        EXPECT_TRUE(mentions(readError(open(other.first, kind), "Aloe", kind + "/Aloe/disp1.png"),
                             {other.first, "Use the kind " + kind + "."}));
      }
    }
  }
}

TEST_F(DataSetTest, DerivesVisibilityOf2005WithoutRightTruth) {
  writeMiddlebury2005Scene("2005/Art");
  fs::remove(folder_.file("2005/Art/disp5.png"));
  const StereoScene scene = open("middlebury_2005", "2005").read("Art");
  EXPECT_EQ(difference(scene.visible, visibleInBoth(scene.truth)), 0.0);
}

TEST_F(DataSetTest, ReadsKitti) {
  writeKittiScene("000007_10", "2012/", "image_0", "image_1", "disp_noc");
  writeKittiScene("000001_10", "2015/", "image_2", "image_3", "disp_noc_0");
  const cv::Mat visible =
      (cv::Mat_<uchar>(kHeight, kWidth) << 0, 0, 255, 255, 0, 255, 0, 0, 0, 0, 0, 255);
  for (const auto& [kind, folder, name] : std::vector<std::array<const char*, 3>>{
           {"kitti2012", "2012", "000007_10"}, {"kitti2015", "2015", "000001_10"}}) {
    const DataSet data_set = open(kind, folder);
    EXPECT_EQ(data_set.scenes(), Names{name});
    const StereoScene scene = data_set.read(name);
    EXPECT_EQ(scene.left_color.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
    EXPECT_EQ(scene.truth.at<float>(0, 2), 2.0F);
    EXPECT_EQ(scene.truth.at<float>(0, 3), 0.5F);
    EXPECT_EQ(scene.truth.at<float>(0, 5), 1.0F / 256.0F);
    EXPECT_EQ(difference(scene.visible, visible), 0.0);
    EXPECT_EQ(difference((scene.truth == scene.truth), visible), 0.0);
    EXPECT_EQ(scene.calibration.disparities, kWidth);  // 228, limited to the width
  }
}

TEST_F(DataSetTest, TakesTheTruthOfOccludedPixelsOfKitti) {
  writeKittiScene("000001_10", "2015/", "image_2", "image_3", "disp_noc_0");
  cv::Mat occ = noc_.clone();
  occ.at<std::uint16_t>(0, 0) = 1024;
  occ.at<std::uint16_t>(0, 2) = 9999;  // disp_noc is used where both are known
  writeImage(place("2015/disp_occ_0/000001_10.png"), occ);
  const StereoScene scene = open("kitti2015", "2015").read("000001_10");
  EXPECT_EQ(scene.truth.at<float>(0, 0), 4.0F);
  EXPECT_EQ(scene.truth.at<float>(0, 2), 2.0F);
  EXPECT_TRUE(isUnknown(scene.truth.at<float>(0, 1)));
  EXPECT_EQ(scene.visible.at<uchar>(0, 0), 0);
  EXPECT_EQ(scene.visible.at<uchar>(0, 2), 255);
}

TEST_F(DataSetTest, SearchesTheRangeOfTheKindOnWideImages) {
  const cv::Mat image = cv::Mat::zeros(1, 300, CV_8UC1);
  const cv::Mat truth(1, 300, CV_16UC1, cv::Scalar(256));
  for (const char* name : {"2005/Art/view1.png", "2005/Art/view5.png", "2012/image_0/a.png",
                           "2012/image_1/a.png", "2005/Art/disp1.png"}) {
    writeImage(place(name), image);
  }
  writeImage(place("2012/disp_noc/a.png"), truth);
  EXPECT_EQ(open("middlebury_2005", "2005").read("Art").calibration.disparities, 85);
  EXPECT_EQ(open("kitti2012", "2012").read("a").calibration.disparities, 228);
}

TEST_F(DataSetTest, Eth3dMayLackTheNumberOfDisparities) {
  writeMiddleburyScene("eth/room");
  const DataSet data_set = open("eth3d", "eth");
  EXPECT_EQ(data_set.read("room").calibration.disparities, 4);
  const std::string matrix = "=[500 0 2; 0 500 1; 0 0 1]\n";
  folder_.write("eth/room/calib.txt",
                "cam0" + matrix + "cam1" + matrix + "baseline=60\nwidth=6\nheight=2\n");
  EXPECT_EQ(data_set.read("room").calibration.disparities, kWidth);  // 64, limited to the width
  EXPECT_TRUE(mentions(readError(open("middlebury_v3", "eth"), "room", "eth/room/calib.txt"),
                       {"ndisp is missing"}));
}

TEST_F(DataSetTest, ReadsAList) {
  writePair("list/a/left.png", "list/a/right.png");
  writePair("list/b/left.png", "list/b/right.png");
  writeImage(place("list/a/truth.png"), noc_);
  writePfm(place("list/b/truth.pfm"), cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(1.5)));
  folder_.write("list/pairs.txt",
                "\xEF\xBB\xBF# my pairs\n\n b/left.png b/right.png\tb/truth.pfm 1\r\n"
                "./a/left.png a/right.png a/truth.png 256 5  # five\n");
  const DataSet data_set = open("list", "list/pairs.txt");
  EXPECT_EQ(data_set.title(), "list pairs");
  EXPECT_EQ(data_set.scenes(), (Names{"a_left", "b_left"}));
  const StereoScene a = data_set.read("a_left");
  EXPECT_EQ(a.truth.at<float>(0, 2), 2.0F);
  EXPECT_TRUE(isUnknown(a.truth.at<float>(0, 0)));
  EXPECT_EQ(a.calibration.disparities, 5);
  EXPECT_EQ(difference(a.visible, visibleInBoth(a.truth)), 0.0);
  const StereoScene b = data_set.read("b_left");
  EXPECT_EQ(b.truth.at<float>(1, 1), 1.5F);
  EXPECT_EQ(b.calibration.disparities, 3);  // 0, 1, 2
}

TEST_F(DataSetTest, AListWithHugeTruthSearchesTheWholeImage) {
  writePair("left.png", "right.png");
  writePfm(place("truth.pfm"), cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(1e30)));
  folder_.write("pairs.txt", "left.png right.png truth.pfm 1\n");
  EXPECT_EQ(open("list", "pairs.txt").read("left").calibration.disparities, kWidth);
}

TEST_F(DataSetTest, NamesTheLineOfAListThatIsWrong) {
  const auto error = [&](const std::string& content) {
    folder_.write("pairs.txt", content);
    return errorText([&] { open("list", "pairs.txt"); });
  };
  const std::string where = folder_.file("pairs.txt") + ", line 2";
  for (const char* line : {"l.png r.png d.png", "l.png r.png d.png x", "l.png r.png d.png 0",
                           "l.png r.png d.png -1", "l.png r.png d.png 1 0", "l.png r.png d.png 1 x",
                           "l.png r.png d.png 1 4 5", "l.png r.png d.png 1 2.5", "l.png"}) {
    EXPECT_TRUE(mentions(error(std::string("# none\n") + line), {where, "invalid line, expected"}))
        << line;
  }
  EXPECT_TRUE(mentions(error("a/l.png r d 1\na_l.jpg r d 1\n"), {where, "a_l", "line 1"}));
  EXPECT_TRUE(mentions(error("# empty\n"), {"pairs.txt", "has no scene"}));
  EXPECT_TRUE(mentions(errorText([&] { open("list", "absent.txt"); }), {"absent.txt", "no such"}));
  fs::resize_file(folder_.file("pairs.txt"), (64 << 20) + 1);
  EXPECT_TRUE(mentions(errorText([&] { open("list", "pairs.txt"); }), {"at most 67108864"}));
}

TEST_F(DataSetTest, NamesTheKindOrFolderThatIsWrong) {
  for (const char* name : {"", "middlebury:x", "x", "/middlebury_v3"}) {
    EXPECT_TRUE(mentions(errorText([&] { DataSet::open(name); }), {name, "kitti2012", "eth3d"}));
  }
  for (const char* name : {"kitti2012", "eth3d:"}) {
    EXPECT_TRUE(
        mentions(errorText([&] { DataSet::open(name); }), {name, "no folder or file after ':'"}));
  }
  fs::create_directory(folder_.file("empty"));
  for (const char* kind : {"middlebury_v3", "middlebury_2005", "eth3d"}) {
    EXPECT_TRUE(mentions(errorText([&] { open(kind, "empty"); }), {"empty", "has no scene"}));
    EXPECT_TRUE(mentions(errorText([&] { open(kind, "absent"); }), {"absent", "no such folder"}));
  }
  EXPECT_TRUE(mentions(errorText([&] { open("kitti2015", "empty"); }), {"empty/disp_noc_0"}));
}

TEST_F(DataSetTest, NamesTheFileThatIsWrong) {
  writeMiddleburyScene("v3/Teddy");
  writeMiddlebury2005Scene("2005/Art");
  writeKittiScene("a", "2012/", "image_0", "image_1", "disp_noc");
  const DataSet v3 = open("middlebury_v3", "v3");
  const DataSet art = open("middlebury_2005", "2005");
  const DataSet kitti = open("kitti2012", "2012");
  EXPECT_TRUE(mentions(errorText([&] { v3.read("Art"); }), {"v3", "no scene Art"}));
  const cv::Mat other = cv::Mat::ones(kHeight + 1, kWidth, CV_8UC1);
  const auto is_wrong_size = [&](const DataSet& set, const char* scene, const char* file) {
    writeImage(folder_.file(file), other);
    EXPECT_TRUE(mentions(readError(set, scene, file), {"6x3", "6x2"}));
    fs::remove(folder_.file(file));
  };
  const auto is_missing = [&](const DataSet& set, const char* scene, const char* file) {
    EXPECT_TRUE(mentions(readError(set, scene, file), {"no such file"}));
  };
  is_wrong_size(art, "Art", "2005/Art/disp5.png");
  is_wrong_size(art, "Art", "2005/Art/disp1.png");
  is_missing(art, "Art", "2005/Art/disp1.png");
  fs::create_directories(folder_.file("2012/disp_occ"));
  is_wrong_size(kitti, "a", "2012/disp_occ/a.png");
  is_wrong_size(kitti, "a", "2012/disp_noc/a.png");
  is_missing(kitti, "a", "2012/disp_noc/a.png");
  is_wrong_size(kitti, "a", "2012/image_1/a.png");
  is_missing(kitti, "a", "2012/image_1/a.png");
  writeMiddleburyCalibration(folder_.file("v3/Teddy/calib.txt"),
                             {500, 2, 2, 1, 0.1, kWidth, kHeight, kWidth + 1});
  EXPECT_TRUE(mentions(readError(v3, "Teddy", "v3/Teddy/calib.txt"), {"ndisp is 7", "most", "6"}));
  fs::resize_file(folder_.file("v3/Teddy/disp0GT.pfm"), 40);
  EXPECT_TRUE(mentions(readError(v3, "Teddy", "v3/Teddy/disp0GT.pfm"), {"40 bytes"}));
}

TEST_F(DataSetTest, AListThatWantsMoreDisparitiesThanColumnsIsNamed) {
  writePair("l.png", "r.png");
  writeImage(folder_.file("d.png"), noc_);
  folder_.write("pairs.txt", "l.png r.png d.png 256 7\n");
  EXPECT_TRUE(
      mentions(readError(open("list", "pairs.txt"), "l", "pairs.txt, line 1"), {"ndisp is 7"}));
}

TEST_F(DataSetTest, MayLackTheTruthWhereItIsOptional) {
  writeMiddleburyScene("v3/Train");
  writeMiddleburyScene("v3/Test");
  fs::remove(folder_.file("v3/Test/disp0GT.pfm"));
  for (const char* kind : {"middlebury_v3", "eth3d"}) {
    const DataSet data_set = open(kind, "v3", Truth::kOptional);
    EXPECT_EQ(data_set.folder(), folder_.file("v3"));
    const StereoScene test = data_set.read("Test");
    EXPECT_TRUE(test.truth.empty() && test.visible.empty());
    EXPECT_EQ(test.calibration.disparities, 4);
    EXPECT_FALSE(data_set.read("Train").truth.empty());
    EXPECT_TRUE(mentions(readError(open(kind, "v3"), "Test", "v3/Test/disp0GT.pfm"), {"no such"}));
  }
}

TEST_F(DataSetTest, TestScenesOfKittiAreTheirLeftImagesOfFrame10) {
  writePair("testing/image_2/000000_10.png", "testing/image_3/000000_10.png");
  writePair("testing/image_2/000000_11.png", "testing/image_3/000000_11.png");
  const DataSet data_set = open("kitti2015", "testing", Truth::kOptional);
  EXPECT_EQ(data_set.scenes(), Names{"000000_10"});
  EXPECT_TRUE(data_set.read("000000_10").truth.empty());
  EXPECT_TRUE(mentions(errorText([&] { open("kitti2015", "testing"); }), {"disp_noc_0"}));
  EXPECT_TRUE(mentions(errorText([&] { open("kitti2012", "testing", Truth::kOptional); }),
                       {"testing/image_0", "no such folder"}));
  writeKittiScene("a", "2012/", "image_0", "image_1", "disp_noc");
  EXPECT_EQ(open("kitti2012", "2012", Truth::kOptional).scenes(), Names{"a"});
}

TEST_F(DataSetTest, ChoosesScenes) {
  for (const char* scene : {"v3/A", "v3/B", "v3/C", "more/D"}) {
    writeMiddleburyScene(scene);
  }
  const std::vector<DataSet> sets = {open("middlebury_v3", "v3"), open("eth3d", "more")};
  const auto names = [&](const SceneFilter& filter) {
    std::string text;
    for (const SceneReference& scene : chooseScenes(sets, filter)) {
      EXPECT_EQ(scene.read().name, scene.scene);
      text += scene.scene;
    }
    return text;
  };
  EXPECT_EQ(names({}), "ABCD");
  EXPECT_EQ(names({{"D", "A"}, {}}), "AD");
  EXPECT_EQ(names({{}, {"B", "D"}}), "AC");
  EXPECT_EQ(names({{"A", "B"}, {"B"}}), "A");
  EXPECT_TRUE(mentions(errorText([&] { names({{"A", "E"}, {}}); }), {"scene E"}));
  EXPECT_TRUE(mentions(errorText([&] { names({{}, {"F"}}); }), {"scene F"}));
  EXPECT_TRUE(mentions(errorText([&] { names({{"A"}, {"A"}}); }), {"all scenes are excluded"}));
}

/// CBMV_DATA is the folder of the data sets. The number of scenes may vary.
TEST(DataSets, OfResearchersCanBeRead) {
  const char* const data = std::getenv("CBMV_DATA");
  if (data == nullptr) {
    GTEST_SKIP() << "CBMV_DATA names no data folder";
  }
  const std::string folder = std::string(data) + "/";
  for (const std::string& name :
       {"middlebury_v3:" + folder + "middlebury_eval3_Q",
        "middlebury_2005:" + folder + "middlebury_2005",
        "middlebury_2005:" + folder + "middlebury_2006", "kitti2012:" + folder + "kitti2012",
        "kitti2015:" + folder + "kitti2015"}) {
    const DataSet data_set = DataSet::open(name);
    const StereoScene scene = data_set.read(data_set.scenes().front());
    double lowest = 0.0;
    double highest = 0.0;
    cv::minMaxLoc(scene.truth, &lowest, &highest, nullptr, nullptr, scene.truth == scene.truth);
    EXPECT_GE(lowest, 0.0) << name;
    EXPECT_LE(highest, scene.calibration.disparities) << name;
    EXPECT_GT(cv::countNonZero(scene.visible), scene.left.total() / 10) << name;
  }
}

}  // namespace
}  // namespace cbmv
