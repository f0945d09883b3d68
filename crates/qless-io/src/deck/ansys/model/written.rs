//! What a deck has written to files of its own, and may read again.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::deck::ansys::syntax::control::TextPosition;
use crate::deck::ansys::syntax::parameters::ApdlParameters;

/// Name and extension.
pub type FileName = (Vec<u8>, Vec<u8>);

/// The text of a database that is resumed, or the line and title of the command if its content is not known.
pub type Resumed = Result<Arc<[TextPart]>, (u32, String)>;

/// A part of the text: where it begins, and the byte at which it ends.
pub type TextPart = (TextPosition, usize);

/// The files that the deck has written. A name that is missing stands for a file whose content is not known.
#[derive(Clone, Debug, Default)]
pub struct WrittenFiles {
    pub databases: FxHashMap<FileName, Arc<[TextPart]>>,
    pub parameters: FxHashMap<FileName, Arc<ApdlParameters>>,
    /// The job's name, which files without a name have; and the name that `/CLEAR` gives back. Empty before `/FILNAME`.
    pub job: Vec<u8>,
    pub session: Vec<u8>,
}

impl WrittenFiles {
    /// Any file may have changed.
    pub fn forget(&mut self) {
        self.databases.clear();
        self.parameters.clear();
    }

    /// `/CLEAR` gives the job the name of the session.
    pub fn clear(&mut self) {
        self.job.clone_from(&self.session);
    }
}
