//! What only the plane has.

use std::sync::Arc;

use arabesque_core::{Domain, Drawn, Exemplar, Outcome, Placement, Region, Request, Result, Snapshot, Vector, Watch};

use crate::{
    orderly::Orderly,
    regular::{Filled, Regular},
};

mod sealed {
    pub trait Sealed {}
    impl Sealed for arabesque_core::Vector<2> {}
    impl Sealed for arabesque_core::Vector<3> {}
}

/// The dimensions that patterns are made in, the plane and space, implemented for the vectors of both.
///
/// The engine is written once for the two. Outlines of elements, things in the way and strokes that turn at the border
/// have a meaning in the plane alone; what handles them asks here whether it is there.
pub trait Dimension<const D: usize>: sealed::Sealed {
    /// An exemplar of the plane.
    fn plane_exemplar(exemplar: &Exemplar<D>) -> Option<&Exemplar<2>>;

    /// A request for the plane.
    fn plane_request(request: &Request<D>) -> Option<&Request<2>>;

    /// A domain of the plane.
    fn plane_domain(domain: &Domain<D>) -> Option<&Domain<2>>;

    /// Placements in the plane.
    fn plane_placements(placements: &mut Vec<Placement<D>>) -> Option<&mut Vec<Placement<2>>>;

    /// Changes strokes that are in the plane; those in space stay as they are.
    ///
    /// # Errors
    /// What `change` gives.
    fn map_plane_strokes(
        strokes: Vec<Drawn<D>>,
        change: impl FnOnce(Vec<Drawn<2>>) -> Result<Vec<Drawn<2>>>,
    ) -> Result<Vec<Drawn<D>>>;

    /// Fills a domain of the plane from an exemplar that repeats; `None` in space.
    ///
    /// # Errors
    /// As for filling it.
    #[doc(hidden)]
    fn fill_plane(
        regular: &Regular,
        exemplar: &Exemplar<D>,
        request: &Request<D>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<Option<Filled<D>>>;

    /// Fills a domain of the plane from an exemplar that keeps to lines of its own; `None` in space, and where the request asks for
    /// what that cannot do.
    ///
    /// # Errors
    /// As for filling it.
    #[doc(hidden)]
    fn fill_orderly(
        orderly: &Orderly,
        exemplar: &Exemplar<D>,
        request: &Request<D>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<Option<Outcome<D>>>;

    /// A region of the plane, as one of this dimension.
    fn from_plane(region: Arc<dyn Region<2>>) -> Option<Arc<dyn Region<D>>>;
}

impl Dimension<2> for Vector<2> {
    fn plane_exemplar(exemplar: &Exemplar<2>) -> Option<&Exemplar<2>> {
        Some(exemplar)
    }

    fn plane_request(request: &Request<2>) -> Option<&Request<2>> {
        Some(request)
    }

    fn plane_domain(domain: &Domain<2>) -> Option<&Domain<2>> {
        Some(domain)
    }

    fn plane_placements(placements: &mut Vec<Placement<2>>) -> Option<&mut Vec<Placement<2>>> {
        Some(placements)
    }

    fn map_plane_strokes(
        strokes: Vec<Drawn<2>>,
        change: impl FnOnce(Vec<Drawn<2>>) -> Result<Vec<Drawn<2>>>,
    ) -> Result<Vec<Drawn<2>>> {
        change(strokes)
    }

    fn fill_plane(
        regular: &Regular,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Option<Filled<2>>> {
        regular.fill(exemplar, request, watch).map(Some)
    }

    fn fill_orderly(
        orderly: &Orderly,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Option<Outcome<2>>> {
        orderly.fill(exemplar, request, watch)
    }

    fn from_plane(region: Arc<dyn Region<2>>) -> Option<Arc<dyn Region<2>>> {
        Some(region)
    }
}

impl Dimension<3> for Vector<3> {
    fn plane_exemplar(_: &Exemplar<3>) -> Option<&Exemplar<2>> {
        None
    }

    fn plane_request(_: &Request<3>) -> Option<&Request<2>> {
        None
    }

    fn plane_domain(_: &Domain<3>) -> Option<&Domain<2>> {
        None
    }

    fn plane_placements(_: &mut Vec<Placement<3>>) -> Option<&mut Vec<Placement<2>>> {
        None
    }

    fn map_plane_strokes(
        strokes: Vec<Drawn<3>>,
        _: impl FnOnce(Vec<Drawn<2>>) -> Result<Vec<Drawn<2>>>,
    ) -> Result<Vec<Drawn<3>>> {
        Ok(strokes)
    }

    fn fill_plane(
        _: &Regular,
        _: &Exemplar<3>,
        _: &Request<3>,
        _: &mut dyn Watch<Snapshot<3>>,
    ) -> Result<Option<Filled<3>>> {
        Ok(None)
    }

    fn fill_orderly(
        _: &Orderly,
        _: &Exemplar<3>,
        _: &Request<3>,
        _: &mut dyn Watch<Snapshot<3>>,
    ) -> Result<Option<Outcome<3>>> {
        Ok(None)
    }

    fn from_plane(_: Arc<dyn Region<2>>) -> Option<Arc<dyn Region<3>>> {
        None
    }
}
