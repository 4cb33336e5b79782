# A case of yours, anywhere: from its meshes to its report. Run with: workflows/run PATH/case.toml
#
# Paths in the case are relative to its folder, and stay so: the case is read where it is. A shape file X.shape.h5 that it names and that is not
# there is made, in the folder of the results, in one of two ways:
#   - from a mesh X of any format beside it (X.stl, X.obj, ...), by "import", with --surface if only walls use it;
#   - by the words for scree-mesher that meshes.toml gives it, in the folder of the case, whether a mesh is there or not:
#       rock = "import scan.stl --unit mm"
#       cube = 'generate box --size "1 cm, 1 cm, 1 cm"'
# Settings are those of pipeline.smk, for instance --config statistics="--from 2".
import os
import sys

sys.path.insert(0, workflow.basedir)
from own_case import OwnCase, Wrong

try:
    own = OwnCase(os.environ["SCREE_CASE"], os.getcwd())
except Wrong as reason:
    raise WorkflowError(str(reason))

SHAPES = own.shapes
RUNS = {own.name: (own.path, own.words)}
PACK_INPUTS = own.inputs


include: "pipeline.smk"


rule all:
    default_target: True
    input: everything()
