-- A library of version 0.3.0, written by its own tables, with a row of every kind.
BEGIN TRANSACTION;
CREATE TABLE alembic_version (
	version_num VARCHAR(32) NOT NULL, 
	CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num)
);
INSERT INTO "alembic_version" VALUES('0016');
CREATE TABLE audit_entry (
	id INTEGER NOT NULL, 
	time DATETIME NOT NULL, 
	name VARCHAR(80) NOT NULL, 
	role VARCHAR(16) NOT NULL, 
	address VARCHAR(64) NOT NULL, 
	method VARCHAR(16) NOT NULL, 
	path VARCHAR(300) NOT NULL, 
	status INTEGER NOT NULL, 
	request_id VARCHAR(64) NOT NULL, 
	PRIMARY KEY (id)
);
INSERT INTO "audit_entry" VALUES(1,'2026-01-02 03:04:05.000000','boat','edit','127.0.0.1','POST','/api/v1/clips',202,'r');
CREATE TABLE change_count (
	id INTEGER NOT NULL, 
	changes INTEGER NOT NULL, 
	PRIMARY KEY (id)
);
INSERT INTO "change_count" VALUES(1,0);
CREATE TABLE clip (
	id VARCHAR(32) NOT NULL, 
	name VARCHAR(200) NOT NULL, 
	media_type VARCHAR(64) NOT NULL, 
	size INTEGER NOT NULL, 
	width INTEGER NOT NULL, 
	height INTEGER NOT NULL, 
	duration FLOAT, 
	frames INTEGER, 
	idempotency_key VARCHAR(255), 
	created DATETIME NOT NULL, 
	deleted DATETIME, topics TEXT DEFAULT '[]' NOT NULL, topic VARCHAR(255), options TEXT, source VARCHAR(16) DEFAULT 'video' NOT NULL, owner VARCHAR(80) DEFAULT '' NOT NULL, 
	PRIMARY KEY (id), 
	UNIQUE (idempotency_key)
);
INSERT INTO "clip" VALUES('cccccccccccccccccccccccccccccccc','dive ''one''.mp4','video/mp4',1234,640,480,2.5,50,'key-1','2026-01-02 03:04:05.678901',NULL,'[]',NULL,NULL,'video','');
INSERT INTO "clip" VALUES('dddddddddddddddddddddddddddddddd','gone.mp4','video/mp4',1234,640,480,NULL,NULL,NULL,'2026-01-02 03:04:05.678901','2026-01-03 00:00:00.000000','[]',NULL,NULL,'video','');
CREATE TABLE demonstration_source (
	trajectory VARCHAR(64) NOT NULL, 
	clip_id VARCHAR(32) NOT NULL, 
	start FLOAT NOT NULL, 
	"end" FLOAT NOT NULL, 
	keep_transit BOOLEAN NOT NULL, 
	PRIMARY KEY (trajectory), 
	FOREIGN KEY(clip_id) REFERENCES clip (id) ON DELETE CASCADE
);
INSERT INTO "demonstration_source" VALUES('ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff','cccccccccccccccccccccccccccccccc',0.5,1.5,0);
CREATE TABLE invitation (
	id VARCHAR(32) NOT NULL, 
	language_id VARCHAR(32) NOT NULL, 
	sha256 VARCHAR(64) NOT NULL, 
	owner VARCHAR(80) NOT NULL, 
	most_takes INTEGER NOT NULL, 
	most_bytes INTEGER NOT NULL, 
	takes INTEGER NOT NULL, 
	bytes INTEGER NOT NULL, 
	created DATETIME NOT NULL, 
	expires DATETIME NOT NULL, 
	withdrawn DATETIME, 
	PRIMARY KEY (id), 
	FOREIGN KEY(language_id) REFERENCES language (id) ON DELETE CASCADE, 
	UNIQUE (sha256)
);
INSERT INTO "invitation" VALUES('88888888888888888888888888888888','aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa','7777777777777777777777777777777777777777777777777777777777777777','boat',5,1000,1,10,'2026-01-02 03:04:05.000000','2026-01-09 03:04:05.000000',NULL);
CREATE TABLE invited_take (
	id VARCHAR(32) NOT NULL, 
	invitation_id VARCHAR(32) NOT NULL, 
	clip_id VARCHAR(32) NOT NULL, 
	label VARCHAR(200) NOT NULL, 
	diver VARCHAR(80) NOT NULL, 
	size INTEGER NOT NULL, 
	status VARCHAR(16) NOT NULL, 
	reason TEXT, 
	claimed DATETIME, 
	created DATETIME NOT NULL, 
	PRIMARY KEY (id), 
	CONSTRAINT invited_take_status CHECK (status IN ('waiting', 'added', 'returned')), 
	FOREIGN KEY(invitation_id) REFERENCES invitation (id) ON DELETE CASCADE
);
INSERT INTO "invited_take" VALUES('66666666666666666666666666666666','88888888888888888888888888888888','cccccccccccccccccccccccccccccccc','circle','Ben',10,'added',NULL,NULL,'2026-01-02 03:04:05.000000');
CREATE TABLE job (
	id VARCHAR(32) NOT NULL, 
	clip_id VARCHAR(32) NOT NULL, 
	client VARCHAR(64) NOT NULL, 
	status VARCHAR(16) NOT NULL, 
	attempts INTEGER NOT NULL, 
	frames INTEGER, 
	error_code VARCHAR(64), 
	error TEXT, 
	warnings TEXT NOT NULL, 
	created DATETIME NOT NULL, 
	started DATETIME, 
	finished DATETIME, server VARCHAR(32), lease DATETIME, salute_warnings TEXT DEFAULT '[]' NOT NULL, 
	PRIMARY KEY (id), 
	CONSTRAINT job_status CHECK (status IN ('queued', 'running', 'done', 'failed', 'cancelled')), 
	FOREIGN KEY(clip_id) REFERENCES clip (id) ON DELETE CASCADE
);
INSERT INTO "job" VALUES('00000000000000000000000000000000','cccccccccccccccccccccccccccccccc','127.0.0.1','done',1,50,NULL,NULL,'["a warning"]','2026-01-02 03:04:06.000000','2026-01-02 03:04:07.000000','2026-01-02 03:04:08.000000',NULL,NULL,'[]');
INSERT INTO "job" VALUES('11111111111111111111111111111111','dddddddddddddddddddddddddddddddd','127.0.0.1','failed',1,NULL,'decoder','broken','[]','2026-01-02 03:04:06.000000','2026-01-02 03:04:07.000000','2026-01-02 03:04:08.000000',NULL,NULL,'[]');
CREATE TABLE labelled_result (
	take_id VARCHAR(32) NOT NULL, 
	revision INTEGER NOT NULL, 
	recognition_id VARCHAR(32), 
	label VARCHAR(200), 
	nearest VARCHAR(200), 
	confidence FLOAT NOT NULL, 
	fault TEXT, 
	created DATETIME NOT NULL, pair TEXT, 
	PRIMARY KEY (take_id, revision), 
	FOREIGN KEY(take_id) REFERENCES labelled_take (id) ON DELETE CASCADE
);
INSERT INTO "labelled_result" VALUES('bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb',1,NULL,'circle','circle',0.9,NULL,'2026-01-02 03:07:05.000000',NULL);
CREATE TABLE labelled_take (
	id VARCHAR(32) NOT NULL, 
	language_id VARCHAR(32) NOT NULL, 
	clip_id VARCHAR(32) NOT NULL, 
	start FLOAT NOT NULL, 
	"end" FLOAT NOT NULL, 
	expected VARCHAR(200) NOT NULL, 
	created DATETIME NOT NULL, 
	PRIMARY KEY (id), 
	FOREIGN KEY(language_id) REFERENCES language (id) ON DELETE CASCADE, 
	FOREIGN KEY(clip_id) REFERENCES clip (id) ON DELETE CASCADE, 
	CONSTRAINT labelled_range UNIQUE (language_id, clip_id, start)
);
INSERT INTO "labelled_take" VALUES('bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb','aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa','cccccccccccccccccccccccccccccccc',0.5,1.5,'circle','2026-01-02 03:07:05.000000');
CREATE TABLE language (
	id VARCHAR(32) NOT NULL, 
	head INTEGER NOT NULL, 
	sample BOOLEAN NOT NULL, 
	created DATETIME NOT NULL, 
	deleted DATETIME, 
	PRIMARY KEY (id)
);
INSERT INTO "language" VALUES('aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',2,0,'2026-01-02 03:05:05.000000',NULL);
CREATE TABLE language_revision (
	language_id VARCHAR(32) NOT NULL, 
	revision INTEGER NOT NULL, 
	name VARCHAR(200) NOT NULL, 
	labels TEXT NOT NULL, 
	change VARCHAR(300) NOT NULL, 
	document TEXT NOT NULL, 
	created DATETIME NOT NULL, author VARCHAR(200) DEFAULT '' NOT NULL, owner VARCHAR(80) DEFAULT '' NOT NULL, size INTEGER DEFAULT '0' NOT NULL, 
	PRIMARY KEY (language_id, revision), 
	FOREIGN KEY(language_id) REFERENCES language (id) ON DELETE CASCADE
);
INSERT INTO "language_revision" VALUES('aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',1,'pool','[]','Created','{
"format": "osg-studio/gesture-language",
"version": 1,
"name": "pool",
"author": "Ada",
"created": "2026-11-29T12:59:01Z",
"revision": 1,
"skeleton": [["left_shoulder","right_shoulder"],["left_shoulder","left_elbow"],["left_elbow","left_wrist"],["right_shoulder","right_elbow"],["right_elbow","right_wrist"],["left_wrist","left_index"],["left_wrist","left_pinky"],["left_wrist","left_thumb"],["right_wrist","right_index"],["right_wrist","right_pinky"],["right_wrist","right_thumb"],["left_shoulder","left_hip"],["right_shoulder","right_hip"],["left_hip","right_hip"],["left_hip","left_knee"],["left_knee","left_ankle"],["right_hip","right_knee"],["right_knee","right_ankle"],["left_ankle","left_foot_index"],["right_ankle","right_foot_index"]],
"settings": {"image_size":224,"image_margin":16,"stroke_width":9,"simplification":4.0,"min_extent":0.1,"max_moments":100,"closing_diameter":28,"hu_floor":0.01,"zernike_degree":8,"fourier_samples":256,"fourier_harmonics":10},
"gestures": [],
"sha256": "28cb8814b0733eeb97bcecc4d70490b37204f27d0cd4547791fd6d0ef20a879e"
}
','2026-01-02 03:05:01.000000','Ada','',0);
INSERT INTO "language_revision" VALUES('aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',2,'pool','[]','Renamed','{
"format": "osg-studio/gesture-language",
"version": 1,
"name": "pool",
"author": "Ada",
"created": "2026-11-29T12:59:01Z",
"revision": 2,
"skeleton": [["left_shoulder","right_shoulder"],["left_shoulder","left_elbow"],["left_elbow","left_wrist"],["right_shoulder","right_elbow"],["right_elbow","right_wrist"],["left_wrist","left_index"],["left_wrist","left_pinky"],["left_wrist","left_thumb"],["right_wrist","right_index"],["right_wrist","right_pinky"],["right_wrist","right_thumb"],["left_shoulder","left_hip"],["right_shoulder","right_hip"],["left_hip","right_hip"],["left_hip","left_knee"],["left_knee","left_ankle"],["right_hip","right_knee"],["right_knee","right_ankle"],["left_ankle","left_foot_index"],["right_ankle","right_foot_index"]],
"settings": {"image_size":224,"image_margin":16,"stroke_width":9,"simplification":4.0,"min_extent":0.1,"max_moments":100,"closing_diameter":28,"hu_floor":0.01,"zernike_degree":8,"fourier_samples":256,"fourier_harmonics":10},
"gestures": [],
"sha256": "8fc534916fdf9f700b437378c6ecc83d79c531d83e4a11a05773af2c5d890397"
}
','2026-01-02 03:05:02.000000','Ada','',0);
CREATE TABLE practice_take (
	id VARCHAR(32) NOT NULL, 
	language_id VARCHAR(32) NOT NULL, 
	clip_id VARCHAR(32) NOT NULL, 
	start FLOAT NOT NULL, 
	diver VARCHAR(80) NOT NULL, 
	expected VARCHAR(200) NOT NULL, 
	label VARCHAR(200), 
	revision INTEGER NOT NULL, 
	recognition_id VARCHAR(32) NOT NULL, 
	created DATETIME NOT NULL, pair TEXT, 
	PRIMARY KEY (id), 
	FOREIGN KEY(language_id) REFERENCES language (id) ON DELETE CASCADE, 
	FOREIGN KEY(clip_id) REFERENCES clip (id) ON DELETE CASCADE
);
INSERT INTO "practice_take" VALUES('99999999999999999999999999999999','aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa','cccccccccccccccccccccccccccccccc',0.5,'Ana','circle','circle',1,'eeeeeeeeeeeeeeeeeeeeeeeeeeeeeeee','2026-01-02 03:08:05.000000',NULL);
CREATE TABLE recognition (
	id VARCHAR(32) NOT NULL, 
	clip_id VARCHAR(32) NOT NULL, 
	language_id VARCHAR(32) NOT NULL, 
	revision INTEGER NOT NULL, 
	start FLOAT NOT NULL, 
	"end" FLOAT NOT NULL, 
	profile VARCHAR(32) NOT NULL, 
	expected VARCHAR(200), 
	result TEXT NOT NULL, 
	created DATETIME NOT NULL, owner VARCHAR(80) DEFAULT '' NOT NULL, size INTEGER DEFAULT '0' NOT NULL, 
	PRIMARY KEY (id), 
	FOREIGN KEY(clip_id) REFERENCES clip (id) ON DELETE CASCADE, 
	FOREIGN KEY(language_id) REFERENCES language (id) ON DELETE CASCADE
);
INSERT INTO "recognition" VALUES('eeeeeeeeeeeeeeeeeeeeeeeeeeeeeeee','cccccccccccccccccccccccccccccccc','aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',1,0.5,1.5,'full','circle','{}','2026-01-02 03:06:05.000000','',0);
CREATE TABLE seeded_sample (
	name VARCHAR(200) NOT NULL, 
	created DATETIME NOT NULL, 
	PRIMARY KEY (name)
);
INSERT INTO "seeded_sample" VALUES('osg-table','2026-01-02 03:04:05.000000');
CREATE TABLE sign_in (
	id VARCHAR(64) NOT NULL, 
	name VARCHAR(80) NOT NULL, 
	proof VARCHAR(64) NOT NULL, 
	created DATETIME NOT NULL, 
	PRIMARY KEY (id)
);
CREATE TABLE upload_reservation (
	id VARCHAR(32) NOT NULL, 
	owner VARCHAR(80) NOT NULL, 
	size INTEGER NOT NULL, 
	touched DATETIME NOT NULL, 
	PRIMARY KEY (id)
);
CREATE INDEX ix_clip_created ON clip (created);
CREATE INDEX ix_language_created ON language (created);
CREATE INDEX ix_job_clip_id ON job (clip_id);
CREATE INDEX ix_job_created ON job (created);
CREATE INDEX ix_job_status ON job (status);
CREATE INDEX ix_recognition_clip_id ON recognition (clip_id);
CREATE INDEX ix_recognition_created ON recognition (created);
CREATE INDEX ix_recognition_language_id ON recognition (language_id);
CREATE INDEX ix_demonstration_source_clip_id ON demonstration_source (clip_id);
CREATE INDEX ix_clip_owner ON clip (owner);
CREATE INDEX ix_audit_entry_name ON audit_entry (name);
CREATE INDEX ix_labelled_take_language_id ON labelled_take (language_id);
CREATE INDEX ix_labelled_take_clip_id ON labelled_take (clip_id);
CREATE INDEX ix_practice_take_language_id ON practice_take (language_id);
CREATE INDEX ix_practice_take_clip_id ON practice_take (clip_id);
CREATE INDEX ix_upload_reservation_owner ON upload_reservation (owner);
CREATE INDEX ix_language_revision_owner ON language_revision (owner);
CREATE INDEX ix_recognition_owner ON recognition (owner);
CREATE INDEX ix_sign_in_name ON sign_in (name);
CREATE INDEX ix_sign_in_created ON sign_in (created);
CREATE INDEX ix_invitation_language_id ON invitation (language_id);
CREATE INDEX ix_invited_take_invitation_id ON invited_take (invitation_id);
CREATE INDEX ix_invited_take_status ON invited_take (status);
COMMIT;
