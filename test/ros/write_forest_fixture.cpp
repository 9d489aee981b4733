// Writes the forest of forest_fixture.h: the node under test reads it when it is launched.

#include "forest/forest_file.h"
#include "support/forest_fixture.h"

int main(int, char** argv) {
  cbmv::writeForest(cbmv::makeForestFixture(), argv[1]);
  return 0;
}
