// Writes the forest of forest_fixture.h to a file, which the node under test reads at its start.

#include "forest/forest_file.h"
#include "support/forest_fixture.h"

int main(int, char** argv) {
  cbmv::writeForest(cbmv::makeForestFixture(), argv[1]);
  return 0;
}
