// Writes the forest of forest_fixture.h: the node under test reads it when it is launched.

#include "support/forest_fixture.h"

#include "cbmv_stereo/forest/forest_file.h"

int main(int, char** argv) {
  cbmv::writeForest(cbmv::makeForestFixture(), argv[1]);
  return 0;
}
