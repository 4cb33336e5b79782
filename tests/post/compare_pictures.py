# Compares two PNG pictures of the same scene on a white ground, pixel by pixel: run by pvbatch, which brings VTK.
# The silhouettes must agree exactly; shading may differ by rounding, since one normal is turned by the graphics
# driver and the other is computed from turned points.
import sys

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader


def read(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)[:, :3]


first, second = read(sys.argv[1]), read(sys.argv[2])
covered = [picture.min(axis=1) < 250 for picture in (first, second)]
silhouette = int((covered[0] != covered[1]).sum())
shading = int((abs(first - second).max(axis=1) > 40).sum())
print("%d and %d pixels covered, silhouettes differ in %d, shading in %d" % (covered[0].sum(), covered[1].sum(), silhouette, shading))
if covered[0].sum() < 1000 or silhouette > 0 or shading > covered[0].sum() // 1000:
    sys.exit(1)
