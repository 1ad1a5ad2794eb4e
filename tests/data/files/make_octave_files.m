% Makes the MAT files that tests/data/octave_files_test.cpp reads. They stand in the repository, so that
% the tests need no Octave:
%   cd tests/data/files && octave --no-gui make_octave_files.m
fs = 512;
t = (0:699)' / fs;
x = 1e-3 * sin (2 * pi * 17.25 * t);
y = single (cos (2 * pi * 3.5 * t));
counts = int16 (round (1000 * sin (t)));
forces = [t, 2 * t, -3 * t];
save ("-v6", "columns_v6.mat", "fs", "t", "x", "y", "counts", "forces");
save ("-v7", "columns_v7.mat", "fs", "t", "x", "y", "counts", "forces");

% channels side by side in the other direction, with names, and a time that is not there
data = forces';
names = {"valve 1", "valve 2", "Prüfling"};
units = {"mA", "bar", "mm"};
title = "Prüfstand";
save ("-v7", "rows_v7.mat", "fs", "data", "names", "units", "title");

% in a structure, with things that are no samples
rig.dt = 1 / fs;
rig.channels = forces;
rig.comment = "not a channel";
rig.settings.gain = 3;
z = complex (x, y);
empty = [];
s = sparse (eye (3));
f = "text";
save ("-v6", "structure_v6.mat", "rig", "z", "empty", "s", "f");
save ("-v7", "structure_v7.mat", "rig", "z", "empty", "s", "f");

% rows and a matrix that is no channel
t = t';
x = x';
odd = ones (3, 5);
save ("-v6", "row_vectors_v6.mat", "t", "x", "odd");
