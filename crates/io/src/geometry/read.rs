//! Files of points and meshes of any kind, told apart by their content.
